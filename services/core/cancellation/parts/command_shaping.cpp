// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/command_shaping.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "services/core/cancellation/parts/part_step.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {

CommandShaping::CommandShaping(const ShapingConfig& config) {
  const double f = config.frequency_hz;
  const double z = config.damping_ratio;
  if (!(f >= 0.01 && f <= 100.0)) {
    throw ConfigError("shaping.frequency_hz", std::to_string(f), "0.01 to 100 Hz");
  }
  if (!(z >= 0.05 && z <= 2.0)) {
    throw ConfigError("shaping.damping_ratio", std::to_string(z), "0.05 to 2");
  }
  // Eq. MI-1 with s = (1 - 1/z)/(1 + 1/z) in units of the prewarped frequency.
  const double w = std::tan(std::numbers::pi * f / kControlRateHz);
  const double norm = 1.0 / (1.0 + 2.0 * z * w + w * w);
  const bool notch = config.kind == ShapingConfig::Kind::kNotch;
  section_.a1 = 2.0 * (w * w - 1.0) * norm;
  section_.a2 = (1.0 - 2.0 * z * w + w * w) * norm;
  section_.b0 = section_.b2 = (notch ? 1.0 + w * w : w * w) * norm;
  section_.b1 = notch ? section_.a1 : 2.0 * section_.b0;
}

// The state of Eq. SG-3 behind an endless constant x, which both kinds give back: y = x.
void CommandShaping::start(double theta_rad) noexcept {
  section_.s2 = (section_.b2 - section_.a2) * theta_rad;
  section_.s1 = (section_.b1 - section_.a1) * theta_rad + section_.s2;
  started_ = true;
}

namespace {
class ShapingStep : public StepOf<ShapingStep> {
 public:
  explicit ShapingStep(const ShapingConfig& config) : shaping_(config) {}
  double filtered_rad(double theta_rad) noexcept override { return shaping_.step(theta_rad); }
  void restart() noexcept override { shaping_.restart(); }

 private:
  CommandShaping shaping_;
};
}  // namespace

std::unique_ptr<PartStep> make_shaping(const Part& part) {
  const auto kind =
      part.kind == PartKind::kNotch ? ShapingConfig::Kind::kNotch : ShapingConfig::Kind::kLowPass;
  return std::make_unique<ShapingStep>(ShapingConfig{kind, part.values[0], part.values[1]});
}

}  // namespace stillhand::cancellation
