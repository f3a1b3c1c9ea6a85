// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/planted_rule.hpp"

namespace stillhand::diagnosis {
namespace {

Comparison asked_of(const MovedResiduals& residuals, Eigen::Index k, double factor, std::size_t i) {
  return compared(residuals.without(k, factor, i), residuals.with(k, factor, i));
}

}  // namespace

double PlantedRule::share_found(Eigen::Index k, double factor, bool left_out) const {
  double found = 0.0;
  for (std::size_t i = 0; i < plain_.count(); ++i) {
    if (left_out ? is_burst(k, factor, i) : is_found(k, factor, i)) found += 1.0;
  }
  return found / static_cast<double>(plain_.count());
}

// Behind the filter, and then without it the error has to fall as well; or without it alone.
bool PlantedRule::is_found(Eigen::Index k, double factor, std::size_t i) const {
  const auto passes = [this](const Comparison& comparison) {
    return worth_it(comparison, options_, round_.least_fall, round_.candidates);
  };
  const Comparison plain = asked_of(plain_, k, factor, i);
  if (passes(plain)) return true;
  return behind_ != nullptr && 1.0 - plain.rmse_ratio > round_.least_fall &&
         passes(asked_of(*behind_, k, factor, i));
}

bool PlantedRule::is_burst(Eigen::Index k, double factor, std::size_t i) const {
  const HeldOut with_burst = plain_.without(k, factor, i);
  return 1.0 - compared(with_burst, plain_.without(k, 0.0, i)).rmse_ratio > options_.large_fall;
}

}  // namespace stillhand::diagnosis
