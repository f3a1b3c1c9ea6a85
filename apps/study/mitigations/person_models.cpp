// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/person_models.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/libraries/session/loop.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "services/core/admittance/arm_fit.hpp"
#include "services/core/admittance/interleaved_multisines.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/identification/arx.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/identification/output_error.hpp"
#include "services/core/identification/rate_conversion.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/population/task.hpp"
#include "services/core/rig/plant.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::study {
namespace {

// The rig's noise differs from record to record of a person.
enum class RecordSeed : std::uint8_t { kPegged, kFree, kRelaxed, kHolding };

rig::RigConfig rig_of(const rig::BodyConfig& body, std::uint64_t seed, RecordSeed use) {
  rig::RigConfig config;
  config.body = body;
  return rig::seeded(config, seed + static_cast<std::uint64_t>(use));
}

// Acceleration, with force on the pegged stick or with displacement of the free one in mm: the same
// fit takes both.
identification::Record moved(const population::Subject& subject, bool pegged, double identify_s,
                             std::uint64_t seed) {
  session::ProtocolOptions protocol;
  protocol.identify_s = identify_s;
  protocol.seed = seed;
  session::PlannedTrial planned = session::identification_trial(protocol);
  planned.trial.start_tick = planned.trial.ramp_ticks + 1;
  motion::MotionGenerator platform(motion::MotionGenerator::Config{});
  platform.arm(motion::MotionTrajectory(session::motion_profile(planned), {}), planned.trial);
  const rig::BodyConfig body =
      pegged ? subject.body : population::doing(subject.body, population::Task::kHold);
  session::Loop loop(rig_of(body, seed, pegged ? RecordSeed::kPegged : RecordSeed::kFree), {});
  const double lever_mm = 1000.0 * rig::StickConfig{}.lever_m;
  // The angle passes the filter that force and acceleration pass, so a ratio is not changed.
  signal::Butterworth of_angle(2, sensing::Config{}.antialias_cutoff_hz, kControlRateHz);
  identification::Record out;
  out.rate_hz = kControlRateHz;
  const Tick last =
      planned.trial.start_tick + planned.trial.duration_ticks + planned.trial.ramp_ticks;
  for (Tick tick = 1; tick < last; ++tick) {
    const session::Turn turn{.command = platform.step(tick),
                             .operator_force_n = 0.0,
                             .pegged = pegged && planned.trial.covers(tick)};
    const auto [sensed, truth] = loop.turn(tick, turn, [](const auto&) { return 0.0; });
    const double displacement_mm = of_angle.step(lever_mm * sensed.theta_rad);
    if (!planned.trial.measures(tick)) continue;
    out.acceleration_m_s2.push_back(sensed.accel_y_m_s2);
    out.force_n.push_back(pegged ? sensed.force_n : displacement_mm);
  }
  return out;
}

// Force and motion at once on a free stick, as services/core/admittance wants it.
admittance::ArmValues fitted_arm(const rig::BodyConfig& body, std::uint64_t seed, RecordSeed use) {
  constexpr std::int64_t kEvery = 4;
  const admittance::Excitation driven = admittance::design({.rate_hz = kControlRateHz});
  const admittance::Excitation read =
      admittance::design({.rate_hz = kControlRateHz / static_cast<double>(kEvery)});
  const rig::RigConfig config = rig_of(body, seed, use);
  session::Loop loop(config, {});
  const double cutoff_hz = sensing::Config{}.antialias_cutoff_hz;
  signal::Butterworth of_angle(2, cutoff_hz, kControlRateHz);
  signal::Butterworth of_motor(2, cutoff_hz, kControlRateHz);
  admittance::FreeStickRecord record;
  record.rate_hz = kControlRateHz / static_cast<double>(kEvery);
  const std::int64_t period = driven.motion.samples_per_period();
  double acted_n = 0.0;
  for (std::int64_t n = 0; n < (kAdmittancePeriods + 1) * period; ++n) {
    const signal::MotionSample moves = driven.motion.at(n);
    const session::Turn turn{.command = {moves.pos_m, moves.vel_m_s, moves.accel_m_s2, kGood},
                             .operator_force_n = 0.0,
                             .permitted = true};
    const double force_n = driven.force.at(n).accel_m_s2;
    const auto [sensed, truth] = loop.turn(n, turn, [&](const auto&) { return force_n; });
    const double before_n = std::exchange(acted_n, truth.motor_force_n);
    // The force is held between samples: their mean is what acted at the sample.
    const double motor_n = of_motor.step(0.5 * (before_n + acted_n));
    const double displacement_m = of_angle.step(config.stick.lever_m * sensed.theta_rad);
    if (n < period || n % kEvery != 0) continue;
    record.motor_force_n.push_back(motor_n);
    record.acceleration_m_s2.push_back(sensed.accel_y_m_s2);
    record.displacement_m.push_back(displacement_m);
    record.hand_force_n.push_back(sensed.force_n);
  }
  return admittance::fit_arm(admittance::estimate(record, read)).values;
}

signal::DifferenceModel scaled(signal::DifferenceModel model, double factor) {
  for (double& c : model.numerator) c *= factor;
  return model;
}

constexpr double kMillimetre_m = 1e-3;

// Models by order from 1 on.  Where an order gives none that runs at 1 kHz, the next higher one
// stands in its place.
template <typename Made>
std::vector<signal::DifferenceModel> by_order(const signal::DifferenceModel& highest,
                                              const Made& made) {
  std::vector<signal::DifferenceModel> out(static_cast<std::size_t>(kReducedOrders), highest);
  for (int order = kReducedOrders - 1; order >= 1; --order) {
    const auto at = static_cast<std::size_t>(order - 1);
    try {
      out[at] = made(order);
    } catch (const ConfigError&) {
      out[at] = out[at + 1];
    }
  }
  return out;
}

// Records of several people, one after another.
identification::Record joined(const std::vector<PersonModels>& people,
                              identification::Record PersonModels::* of) {
  identification::Record out;
  for (const PersonModels& one : people) {
    const identification::Record& from = one.*of;
    out.rate_hz = from.rate_hz;
    out.acceleration_m_s2.insert(out.acceleration_m_s2.end(), from.acceleration_m_s2.begin(),
                                 from.acceleration_m_s2.end());
    out.force_n.insert(out.force_n.end(), from.force_n.begin(), from.force_n.end());
  }
  return out;
}

admittance::ArmValues geometric_mean(const std::vector<PersonModels>& people,
                                     admittance::ArmValues PersonModels::* of) {
  admittance::ArmValues out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    double log_sum = 0.0;
    double sum = 0.0;
    bool positive = true;
    for (const PersonModels& one : people) {
      const double value = (one.*of)[i];
      positive = positive && value > 0.0;
      sum += value;
      log_sum += positive ? std::log(value) : 0.0;
    }
    const auto count = static_cast<double>(people.size());
    // Gains of a reflex that was not found are 0, and have no geometric mean.
    out[i] = positive ? std::exp(log_sum / count) : sum / count;
  }
  return out;
}

}  // namespace

PersonModels identify_person(const population::Subject& subject, double identify_s,
                             std::uint64_t seed) {
  PersonModels out;
  const identification::Record pegged = moved(subject, true, identify_s, seed);
  const auto paper = identification::identify_stepwise(pegged, {}, false);
  out.pegged = paper.control.model;
  out.pegged_record = paper.record;
  out.reduced = by_order(out.pegged, [&](int order) {
    identification::Config config;
    config.order = order;
    // A low order is a poor fit of the equation error; on its free run it is the best of its order.
    config.refine = true;
    return identification::identify_stepwise(pegged, config, false).control.model;
  });
  // The hand's own motion is noise on the output, which biases the equation error.
  identification::Config config;
  config.refine = true;
  const identification::Record freely = moved(subject, false, identify_s, seed);
  const auto steps = identification::identify_stepwise(freely, config, false);
  out.position = scaled(steps.control.model, kMillimetre_m);
  out.position_record = steps.record;
  using population::doing;
  using population::Task;
  out.relaxed = fitted_arm(doing(subject.body, Task::kRelax), seed, RecordSeed::kRelaxed);
  out.holding = fitted_arm(doing(subject.body, Task::kHold), seed, RecordSeed::kHolding);
  return out;
}

PersonModels average_models(const std::vector<PersonModels>& people) {
  PersonModels out;
  const auto refined = [&](identification::Record PersonModels::* of, int order) {
    const identification::Record all = joined(people, of);
    const auto start = identification::least_squares(all, order);
    return identification::to_control_rate(identification::refine_output_error(all, start).model)
        .model;
  };
  std::vector<identification::ArxFactor> factors;
  factors.reserve(people.size());
  for (const PersonModels& one : people) {
    factors.push_back(identification::factor_arx(one.pegged_record, kReducedOrders));
  }
  out.pegged = identification::to_control_rate(identification::fit_pooled(factors)).model;
  out.reduced =
      by_order(out.pegged, [&](int order) { return refined(&PersonModels::pegged_record, order); });
  out.position = scaled(refined(&PersonModels::position_record, kReducedOrders), kMillimetre_m);
  out.relaxed = geometric_mean(people, &PersonModels::relaxed);
  out.holding = geometric_mean(people, &PersonModels::holding);
  return out;
}

KnownPerson known(const PersonModels& models) {
  return {{models.relaxed, models.holding}, models.reduced};
}

}  // namespace stillhand::study
