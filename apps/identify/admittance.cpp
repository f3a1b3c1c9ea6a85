// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/admittance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "apps/libraries/session/session_recording.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/sensing/conditioner.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::identify {
namespace {

struct PerturbedTrial {
  admittance::SessionPerturbation perturbation;
  Tick start_tick = 0, duration_ticks = 0;
  bool held = false;
};

PerturbedTrial perturbed_trial(const session::SessionRecording& session,
                               const std::string& recording) {
  PerturbedTrial out;
  for (const auto& event : session.events) {
    const auto said = admittance::perturbation_in(event.text().c_str());
    if (said.period_s != 0.0) out.perturbation = said;
  }
  for (const auto& control : session.trial_controls) {
    const bool held = control.phase() == stillhand_msgs::PHASE_PEGGED && control.trial() > 0;
    if (control.phase() != stillhand_msgs::PHASE_TRACKING && !held) continue;
    out.held = held;
    out.start_tick = control.start_tick();
    out.duration_ticks = control.duration_ticks();
  }
  if (out.perturbation.period_s == 0.0 || out.duration_ticks == 0) {
    throw ConfigError(recording, "no perturbed trial",
                      "a session of `stillhand lab --identify admittance,feedthrough`");
  }
  return out;
}

// A stream on the ticks of a trial; the last sample before a lost one is held.
template <typename Message, typename Take>
std::int64_t on_ticks(const std::vector<Message>& stream, Tick first, std::size_t count,
                      const Take& take) {
  std::vector<const Message*> at(count, nullptr);
  for (const Message& message : stream) {
    const Tick place = message.tick() - first;
    if (place >= 0 && place < static_cast<Tick>(count)) {
      at[static_cast<std::size_t>(place)] = &message;
    }
  }
  std::int64_t lost = 0;
  const Message* held = nullptr;
  for (std::size_t n = 0; n < count; ++n) {
    if (at[n] != nullptr) {
      held = at[n];
    } else {
      ++lost;
    }
    take(n, held);
  }
  return lost;
}

/// The whole periods of a perturbed trial after the first.
struct PerturbedRecord {
  PerturbedTrial trial;
  admittance::Excitation excitation;
  admittance::FreeStickRecord signals{};
  std::int64_t periods = 0, lost_ticks = 0;
  double largest_force_n = 0.0;
};

PerturbedRecord read_perturbed(const std::string& recording, double lever_m) {
  const session::SessionRecording session = session::read_session(recording);
  const PerturbedTrial trial = perturbed_trial(session, recording);
  PerturbedRecord out{
      .trial = trial,
      .excitation = admittance::design(admittance::session_excitation(trial.perturbation))};
  const Tick period = out.excitation.force.samples_per_period();
  out.periods = out.trial.duration_ticks / period - 1;
  if (out.periods < 4) {
    throw ConfigError(recording, fmt::format("{} periods after the first", out.periods),
                      "four or more");
  }
  // The filter sees the first period too, so that it has settled.
  const auto count = static_cast<std::size_t>((out.periods + 1) * period);
  const auto skip = static_cast<std::size_t>(period);
  const double cutoff_hz = sensing::Config{}.antialias_cutoff_hz;
  signal::Butterworth of_angle(2, cutoff_hz, kControlRateHz);
  signal::Butterworth of_motor(2, cutoff_hz, kControlRateHz);
  admittance::FreeStickRecord& record = out.signals;
  const Tick first = out.trial.start_tick;
  record.rate_hz = kControlRateHz;
  out.lost_ticks += on_ticks(session.sensed, first, count, [&](auto n, const auto* s) {
    const double x = of_angle.step(s != nullptr ? lever_m * s->theta_rad() : 0.0);
    if (n < skip) return;
    record.displacement_m.push_back(x);
    record.acceleration_m_s2.push_back(s != nullptr ? s->accel_y_m_s2() : 0.0);
    record.hand_force_n.push_back(s != nullptr ? s->force_n() : 0.0);
  });
  // A command acts from its tick to the next: at the tick itself the mean of it and the one before.
  double before_n = 0.0;
  out.lost_ticks += on_ticks(session.motor_commands, first, count, [&](auto n, const auto* m) {
    const double now_n = m != nullptr ? m->force_n() : 0.0;
    const double force_n = of_motor.step(0.5 * (before_n + now_n));
    before_n = now_n;
    out.largest_force_n = std::max(out.largest_force_n, std::abs(now_n));
    if (n >= skip) record.motor_force_n.push_back(force_n);
  });
  if (out.lost_ticks * 1000 > static_cast<std::int64_t>(2 * count)) {
    throw ConfigError(recording, fmt::format("{} lost ticks", out.lost_ticks),
                      "at most one in a thousand");
  }
  return out;
}

/// One of the three records of the relation.
PerturbedRecord read_related(const std::string& recording, double lever_m,
                             const admittance::SessionPerturbation& free, bool held) {
  PerturbedRecord out = read_perturbed(recording, lever_m);
  const admittance::SessionPerturbation& own = out.trial.perturbation;
  if (own.period_s != free.period_s || own.seed != free.seed) {
    throw ConfigError(
        recording, fmt::format("period {:g} s, seed {}", own.period_s, own.seed),
        fmt::format("{:g} s and {} of the free stick's session", free.period_s, free.seed));
  }
  if (out.trial.held != held || own.swapped == held) {
    throw ConfigError(recording, "another kind of session",
                      held ? "one of `stillhand lab --identify ... --held-stick`"
                           : "one of `stillhand lab --identify ... --swap-lines`");
  }
  return out;
}

}  // namespace

AdmittanceResult identify_admittance(const AdmittanceRecordings& recordings, double lever_m) {
  const PerturbedRecord free = read_perturbed(recordings.free, lever_m);
  if (free.trial.held || free.trial.perturbation.swapped) {
    throw ConfigError(recordings.free, free.trial.held ? "a held stick" : "swapped lines",
                      "a session without --held-stick and --swap-lines");
  }
  AdmittanceResult out;
  out.recording = recordings.free;
  out.perturbation = free.trial.perturbation;
  out.periods = free.periods;
  out.lost_ticks = free.lost_ticks;
  out.largest_force_n = free.largest_force_n;
  out.lines = admittance::estimate(free.signals, free.excitation);
  out.arm = admittance::fit_arm(out.lines);
  if (recordings.held.empty()) return out;
  const PerturbedRecord held = read_related(recordings.held, lever_m, out.perturbation, true);
  const PerturbedRecord swapped =
      read_related(recordings.swapped, lever_m, out.perturbation, false);
  const auto fewest = 2 * (std::min({free.periods, held.periods, swapped.periods}) - 1);
  out.held_feedthrough = admittance::estimate_pegged(held.signals, held.excitation);
  out.relation = admittance::test_relation(
      out.lines.feedthrough_to_position, out.held_feedthrough,
      admittance::estimate(swapped.signals, swapped.excitation).stick_per_force, fewest);
  return out;
}

}  // namespace stillhand::identify
