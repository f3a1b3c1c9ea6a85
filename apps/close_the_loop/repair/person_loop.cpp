// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/repair/person_loop.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/cancellation/model_check.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/human_operator/crossover_operator.hpp"
#include "services/core/rig/rig.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::close_the_loop {
namespace {

constexpr double kSettle_s = 2.0;

// M x'' + B x' + K x = force, friction bringing the stick to rest within a tick (as RG-4).
class Stick {
 public:
  Stick(const cancellation::HandCompliance& hand, double friction_n)
      : hand_(hand), friction_n_(friction_n) {}

  void step(double force_n) noexcept {
    constexpr double kDt = kControlPeriod_s;
    const double held_n = force_n - hand_.stiffness_n_m * x_m_ - hand_.damping_n_s_m * v_m_s_;
    const double free_m_s = v_m_s_ + kDt * held_n / hand_.mass_kg;
    const double stopped_m_s =
        std::max(std::abs(free_m_s) - kDt * friction_n_ / hand_.mass_kg, 0.0);
    v_m_s_ = std::copysign(stopped_m_s, free_m_s);
    x_m_ += kDt * v_m_s_;
  }
  [[nodiscard]] double theta_rad() const noexcept { return x_m_ / hand_.lever_m; }
  [[nodiscard]] double omega_rad_s() const noexcept { return v_m_s_ / hand_.lever_m; }
  [[nodiscard]] double x_m() const noexcept { return x_m_; }

 private:
  cancellation::HandCompliance hand_;
  double friction_n_;
  double x_m_ = 0.0;
  double v_m_s_ = 0.0;
};

double ripple_n(const std::vector<cancellation::Wave>& waves, double theta_rad) {
  double sum_n = 0.0;
  for (const cancellation::Wave& wave : waves) {
    const double angle = kTwoPi * wave.frequency * theta_rad;
    sum_n += wave.sine_n * std::sin(angle) + wave.cosine_n * std::cos(angle);
  }
  return sum_n;
}

rig::Motor motor_of(const Drive& drive) {
  rig::RigConfig rig;
  rig.motor.delay_s = drive.late_s;
  return {rig.motor, rig.stick.lever_m};
}

cancellation::Countermeasure countermeasure(const cancellation::ControlModel* model) {
  cancellation::Countermeasure out({}, {.force = true});
  if (model == nullptr) return out;
  require_taken(out.load_model(*model), "the canceller's model", "one that the canceller accepts");
  return out;
}

human_operator::CrossoverOperator operator_of(const PersonModel& person, std::uint64_t seed) {
  human_operator::CrossoverConfig config = person.who;
  config.seed = static_cast<std::int64_t>(seed);
  return human_operator::CrossoverOperator(config);
}

std::size_t place(std::uint64_t seed, std::size_t size) {
  constexpr std::uint64_t kStream = 0x7265706169;
  return static_cast<std::size_t>(signal::Gaussian(seed, kStream).uniform() *
                                  static_cast<double>(size));
}

}  // namespace

double tracking_error_mm(const PersonModel& person, const Course& course, const Drive& drive,
                         const cancellation::ControlModel* canceller,
                         const std::vector<double>& unexplained, std::uint64_t seed) {
  const std::vector<double>& felt_n = course.force_n;
  cancellation::Countermeasure counter = countermeasure(canceller);
  rig::Motor motor = motor_of(drive);
  human_operator::CrossoverOperator subject = operator_of(person, seed);
  Stick stick(person.hand, drive.friction_n);
  const std::size_t shift = place(seed, unexplained.size());
  double volition_n = 0.0;
  double motor_n = 0.0;
  double square_m2 = 0.0;
  std::size_t count = 0;
  for (std::size_t n = 0; n < felt_n.size(); ++n) {
    const double own_n = unexplained.empty() ? 0.0 : unexplained[(n + shift) % unexplained.size()];
    stick.step(felt_n[n] + own_n + volition_n + motor_n +
               ripple_n(drive.ripple, stick.theta_rad()));
    cancellation::ChannelSample sensed = course.sensed[n];
    sensed[static_cast<std::size_t>(cancellation::Channel::kTheta)] = stick.theta_rad();
    sensed[static_cast<std::size_t>(cancellation::Channel::kOmega)] = stick.omega_rad_s();
    const Tick tick = course.first_tick + static_cast<Tick>(n);
    const auto wanted = counter.step({tick, sensed, 0, canceller != nullptr, true, {}});
    motor_n = motor.step({true, 0, wanted.force_n, true}).force_n;
    const double cursor_m = person.who.arm.cursor_per_hand * stick.x_m();
    const double error_m = course.target_m[n] - cursor_m;
    volition_n = subject.step({tick, course.target_m[n], cursor_m, true}).force_n;
    if (n < static_cast<std::size_t>(kSettle_s * kControlRateHz)) continue;
    square_m2 += error_m * error_m;
    ++count;
  }
  return kMmPerM * std::sqrt(square_m2 / static_cast<double>(count));
}

}  // namespace stillhand::close_the_loop
