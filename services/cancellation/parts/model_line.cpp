// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/parts/model_line.hpp"

#include <algorithm>
#include <string>

#include "services/contract/config_error.hpp"
#include "services/contract/tick.hpp"

namespace stillhand::cancellation {

ModelLine::ModelLine(const signal::DifferenceModel& model) {
  if (!signal::well_formed(model) || !signal::is_stable(model)) {
    throw ConfigError("mitigation.model", "an unstable or malformed one", "a stable model");
  }
  if (model.rate_hz != kControlRateHz) {
    throw ConfigError("mitigation.model", std::to_string(model.rate_hz) + " Hz", "1000 Hz");
  }
  if (model.order() > kMostOrder) {
    throw ConfigError("mitigation.model", "order " + std::to_string(model.order()),
                      "at most " + std::to_string(kMostOrder));
  }
  order_ = model.order();
  std::ranges::copy(model.numerator, numerator_.begin());
  std::ranges::copy(model.denominator, denominator_.begin());
}

double ModelLine::step(double u) noexcept {
  const double y = numerator_[0] * u + state_[0];
  for (std::size_t i = 1; i <= order_; ++i) {
    state_[i - 1] = state_[i] + numerator_[i] * u - denominator_[i] * y;
  }
  return y;
}

}  // namespace stillhand::cancellation
