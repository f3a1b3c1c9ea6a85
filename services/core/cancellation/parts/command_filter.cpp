// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/command_filter.hpp"

#include <cmath>
#include <string>

#include "services/core/cancellation/parts/part_step.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

signal::SecondOrderLag lag(const HandCompliance& hand) {
  const auto positive = [](const char* key, double value) {
    if (!(value > 0.0 && std::isfinite(value))) {
      throw ConfigError(std::string("command_filter.") + key, std::to_string(value),
                        "a value above 0");
    }
  };
  positive("mass_kg", hand.mass_kg);
  positive("damping_n_s_m", hand.damping_n_s_m);
  positive("stiffness_n_m", hand.stiffness_n_m);
  positive("lever_m", hand.lever_m);
  const double critical_n_s_m = 2.0 * std::sqrt(hand.stiffness_n_m * hand.mass_kg);
  if (!(hand.damping_n_s_m < critical_n_s_m)) {
    throw ConfigError("command_filter.damping_n_s_m", std::to_string(hand.damping_n_s_m),
                      "less than critical, " + std::to_string(critical_n_s_m));
  }
  return {std::sqrt(hand.stiffness_n_m / hand.mass_kg), hand.damping_n_s_m / critical_n_s_m,
          kControlPeriod_s};
}

}  // namespace

CommandFilter::CommandFilter(const HandCompliance& hand)
    : compliance_m_n_(1.0 / hand.stiffness_n_m), lever_m_(hand.lever_m), lag_(lag(hand)) {}

namespace {
class PredictedSignalStep : public StepOf<PredictedSignalStep> {
 public:
  explicit PredictedSignalStep(const HandCompliance& hand) : filter_(hand) {}
  double moved_m(const Moment& now, double lever_m) noexcept override {
    return lever_m * (now.theta_rad - filter_.step(now.theta_rad, now.predicted_n));
  }

 private:
  CommandFilter filter_;
};
}  // namespace

std::unique_ptr<PartStep> make_predicted_signal(const Part& part) {
  const std::vector<double>& v = part.values;
  return std::make_unique<PredictedSignalStep>(sound_hand(part, {v[0], v[1], v[2], v[3]}));
}

}  // namespace stillhand::cancellation
