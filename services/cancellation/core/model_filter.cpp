// SPDX-License-Identifier: Apache-2.0
#include "cancellation/core/model_filter.hpp"

#include <algorithm>

namespace stillhand::cancellation {

ModelFilter::ModelFilter(const signal::DifferenceModel& model, std::int64_t settle_ticks) noexcept
    : order_(model.order()), settle_ticks_(settle_ticks), loaded_(true) {
  std::copy(model.numerator.begin(), model.numerator.end(), c_.begin());
  std::copy(model.denominator.begin(), model.denominator.end(), d_.begin());
}

}  // namespace stillhand::cancellation
