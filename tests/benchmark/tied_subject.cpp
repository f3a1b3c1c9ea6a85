// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmark/tied_subject.hpp"

#include <memory>

#include "apps/libraries/measurement/grid.hpp"
#include "apps/libraries/session/loop.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "services/core/rig/plant.hpp"
#include "tests/planted/to_measurement.hpp"

namespace stillhand::benchmark {
namespace {

planted::Excitation as_given(const motion::MotionTrajectory& motion) {
  planted::Excitation given;
  const Tick ticks = 2 * motion.ramp_ticks() + motion.duration_ticks();
  for (Tick n = 0; n < ticks; ++n) given.given_m_s2.push_back(motion.at(n).acceleration_m_s2);
  given.given_start_s = -static_cast<double>(motion.ramp_ticks()) * kControlPeriod_s;
  return given;
}

diagnosis::Measurement made(std::uint64_t seed, planted::Spec spec,
                            const planted::Excitation& excitation, double seconds) {
  spec.twice = true;
  spec.again_length_s = seconds;
  spec.again_excitation = excitation;
  return planted::to_measurement(*planted::draw(seed, spec).again);
}

rig::SealedEffect effect_of(std::uint64_t seed) { return {seed, rig::RigConfig{}}; }

// As the lab identifies: the noise of the paper, 0.7 to 4 Hz.
motion::MotionTrajectory identifying(std::uint64_t seed, double seconds) {
  session::ProtocolOptions protocol;
  protocol.identify_s = seconds;
  protocol.seed = seed;
  return {session::motion_profile(session::identification_trial(protocol)), {}};
}

// The trial alone, in a session of its own.
diagnosis::Measurement ridden(std::uint64_t effect, std::uint64_t session, const TiedRig& rig,
                              const motion::MotionTrajectory& motion) {
  rig::RigConfig config = rig::seeded({}, session);
  config.sensors.load_cell_noise_n_rthz = rig.noise_n_rthz;
  if (rig.passive) config.body.neuromuscular = {};
  session::Loop loop(config, {}, effect_of(effect));
  recording::Recording rows;
  rows.rate_hz = kControlRateHz;
  rows.columns = {{"a_x", "m/s^2", {}}, {"a_y", "m/s^2", {}}, {"a_z", "m/s^2", {}},
                  {"roll", "rad", {}},  {"theta", "rad", {}}, {"omega", "rad/s", {}},
                  {"f", "N", {}}};
  const Tick first = motion.ramp_ticks();
  for (Tick n = 0; n < first + motion.duration_ticks(); ++n) {
    const auto sensed = loop.turn(n + 1, {.command = motion.at(n), .pegged = true},
                                  [](const sensing::Sensed&) { return 0.0; })
                            .sensed;
    if (n < first) continue;
    const std::array row{sensed.accel_x_m_s2, sensed.accel_y_m_s2, sensed.accel_z_m_s2,
                         sensed.roll_rad,     sensed.theta_rad,    sensed.omega_rad_s,
                         sensed.force_n};
    rows.time_s.push_back(static_cast<double>(n) * kControlPeriod_s);
    for (std::size_t i = 0; i < row.size(); ++i) rows.columns[i].values.push_back(row[i]);
  }
  constexpr std::size_t kMostValues = 60'000'000;
  return measurement::on_grid(std::move(rows), kMostValues);
}

}  // namespace

TiedSubject planted_subject(std::uint64_t seed, const planted::Spec& spec) {
  const planted::Draft draft = planted::draw(seed, spec);
  const planted::PlantedEffect& effect = draft.truth.effects.front();
  return {std::string(planted::name_of(effect.kind)), effect.variant,
          planted::to_measurement(draft.recording),
          [=](const motion::MotionTrajectory& motion) {
            const double seconds = static_cast<double>(motion.duration_ticks()) * kControlPeriod_s;
            return made(seed, spec, as_given(motion), seconds);
          },
          [seed, spec, excitation = draft.truth.excitation](double seconds) {
            return made(seed, spec, excitation, seconds);
          }};
}

TiedSubject rig_subject(std::uint64_t seed, const TiedRig& rig) {
  const rig::OpenedEffect truth = effect_of(seed).open();
  constexpr std::uint64_t kSecond = 1000, kThird = 2000;  // sessions of their own
  return {truth.kind, truth.place, ridden(seed, seed, rig, identifying(seed, rig.seconds)),
          [=](const motion::MotionTrajectory& motion) {
            return ridden(seed, seed + kSecond, rig, motion);
          },
          [=](double seconds) {
            return ridden(seed, seed + kThird, rig, identifying(seed + kThird, seconds));
          }};
}

}  // namespace stillhand::benchmark
