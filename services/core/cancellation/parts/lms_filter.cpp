// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/lms_filter.hpp"

#include <cmath>
#include <string>

#include "services/core/cancellation/parts/part_step.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

constexpr double kLowOfReference_hz = 0.5;
constexpr double kHighOfReference_hz = 6.0;
// With a secondary path: as CC-10 and MI-5, where an average hand's compliance is everybody's.
constexpr double kHighOfForce_hz = 3.0;
constexpr int kReferenceOrder = 2;
// Below this the platform stands still, and there is nothing to learn from.
constexpr double kStill_m_s2 = 0.05;

}  // namespace

LmsFilter::LmsFilter(const LmsConfig& config)
    : step_(config.step),
      reference_band_(kReferenceOrder, kLowOfReference_hz,
                      config.path ? kHighOfForce_hz : kHighOfReference_hz, kControlRateHz),
      error_band_(reference_band_) {
  if (!(step_ > 0.0 && step_ <= 1.0)) {
    throw ConfigError("lms.step", std::to_string(step_), "above 0, at most 1");
  }
  if (config.path) {
    const SecondaryPath& path = *config.path;
    const double critical = 2.0 * std::sqrt(path.stiffness_n_m * path.mass_kg);
    if (!(path.mass_kg > 0.0 && path.stiffness_n_m > 0.0 && path.damping_n_s_m > 0.0 &&
          path.damping_n_s_m < critical)) {
      throw ConfigError("lms.path", "no damped oscillator", "M, K above 0, 0 < B < 2 sqrt(K M)");
    }
    compliance_m_n_ = 1.0 / path.stiffness_n_m;
    path_.emplace(std::sqrt(path.stiffness_n_m / path.mass_kg), path.damping_n_s_m / critical,
                  kControlPeriod_s);
  }
  const double still = kStill_m_s2 * compliance_m_n_;
  floor_ = static_cast<double>(kTaps) * still * still;
}

double LmsFilter::output(double accel_m_s2) noexcept {
  at_ = (at_ + 1) % accel_.size();
  accel_[at_] = accel_m_s2;
  const double felt = path_ ? path_->step(accel_m_s2 * compliance_m_n_).x : accel_m_s2;
  reference_[at_] = reference_band_.step(felt);
  double y = 0.0;
  std::size_t from = at_;
  for (const double weight : weights_) {
    y += weight * accel_[from];
    from = from >= kSpacing_ticks ? from - kSpacing_ticks : from + accel_.size() - kSpacing_ticks;
  }
  return y;
}

void LmsFilter::learn(double error_m, bool learns) noexcept {
  const double e = error_band_.step(error_m);
  if (!learns || at_ % kSpacing_ticks != 0) return;
  double power = floor_;
  for (std::size_t n = at_ % kSpacing_ticks; n < reference_.size(); n += kSpacing_ticks) {
    power += reference_[n] * reference_[n];
  }
  // Eq. MI-3.
  const double scale = step_ * e / power;
  std::size_t from = at_;
  for (double& weight : weights_) {
    weight += scale * reference_[from];
    from = from >= kSpacing_ticks ? from - kSpacing_ticks : from + accel_.size() - kSpacing_ticks;
  }
}

namespace {
class LmsForceStep : public StepOf<LmsForceStep> {
 public:
  explicit LmsForceStep(const LmsConfig& config) : filter_(config) {}
  double force_n(const Moment& now) noexcept override { return -filter_.output(now.accel_m_s2); }
  void learn(double x_m, bool learns) noexcept override { filter_.learn(x_m, learns); }

 private:
  LmsFilter filter_;
};

class LmsSignalStep : public StepOf<LmsSignalStep> {
 public:
  explicit LmsSignalStep(const LmsConfig& config) : filter_(config) {}
  double moved_m(const Moment& now, double /*lever_m*/) noexcept override {
    return moved_m_ = filter_.output(now.accel_m_s2);
  }
  void learn(double x_m, bool learns) noexcept override { filter_.learn(x_m - moved_m_, learns); }

 private:
  LmsFilter filter_;
  double moved_m_ = 0.0;  ///< y at this tick
};
}  // namespace

std::unique_ptr<PartStep> make_lms_force(const Part& part) {
  const std::vector<double>& v = part.values;
  sound_hand(part, {v[1], v[2], v[3], kAverageHand.lever_m});
  return std::make_unique<LmsForceStep>(LmsConfig{v[0], SecondaryPath{v[1], v[2], v[3]}});
}

std::unique_ptr<PartStep> make_lms_signal(const Part& part) {
  return std::make_unique<LmsSignalStep>(LmsConfig{part.values[0], {}});
}

}  // namespace stillhand::cancellation
