// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/admittance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "apps/session/session_recording.hpp"
#include "services/contract/config_error.hpp"
#include "services/sensing/core/conditioner.hpp"
#include "services/signal/butterworth.hpp"

namespace stillhand::identify {
namespace {

struct Perturbed {
  admittance::SessionPerturbation perturbation;
  Tick start_tick = 0, duration_ticks = 0;
};

Perturbed perturbed_trial(const session::SessionRecording& session, const std::string& recording) {
  Perturbed out;
  for (const auto& event : session.events) {
    const auto said = admittance::perturbation_in(event.text().c_str());
    if (said.period_s != 0.0) out.perturbation = said;
  }
  for (const auto& control : session.trial_controls) {
    if (control.phase() != stillhand_msgs::PHASE_TRACKING) continue;
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

}  // namespace

AdmittanceResult identify_admittance(const std::string& recording, double lever_m) {
  const session::SessionRecording session = session::read_session(recording);
  const Perturbed trial = perturbed_trial(session, recording);
  const admittance::Excitation excitation =
      admittance::design(admittance::session_excitation(trial.perturbation));
  const Tick period = excitation.force.samples_per_period();
  AdmittanceResult out;
  out.recording = recording;
  out.perturbation = trial.perturbation;
  out.periods = trial.duration_ticks / period - 1;
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
  admittance::FreeStickRecord record;
  record.rate_hz = kControlRateHz;
  out.lost_ticks += on_ticks(session.sensed, trial.start_tick, count, [&](auto n, const auto* s) {
    const double x = of_angle.step(s != nullptr ? lever_m * s->theta_rad() : 0.0);
    if (n < skip) return;
    record.displacement_m.push_back(x);
    record.acceleration_m_s2.push_back(s != nullptr ? s->accel_y_m_s2() : 0.0);
    record.hand_force_n.push_back(s != nullptr ? s->force_n() : 0.0);
  });
  // A command acts from its tick to the next: at the tick itself the mean of it and the one before.
  double before_n = 0.0;
  out.lost_ticks +=
      on_ticks(session.motor_commands, trial.start_tick, count, [&](auto n, const auto* m) {
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
  out.lines = admittance::estimate(record, excitation);
  out.arm = admittance::fit_arm(out.lines);
  return out;
}

}  // namespace stillhand::identify
