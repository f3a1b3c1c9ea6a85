// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "apps/libraries/session/clock_line.hpp"
#include "apps/libraries/session/in_process.hpp"
#include "apps/libraries/session/measured_ticks.hpp"
#include "services/core/signal/reference.hpp"
#include "services/messages/identification/codec.hpp"

namespace stillhand::session {
namespace {

// The position's model has no number in the motor commands.  The canceller takes the newest, and a
// mitigation that was made before the trial keeps its own.
TrialResult::Models models_of(const SessionRecording& session, const PlannedTrial& planned) {
  TrialResult::Models models;
  if (planned.cancellation || cancellation::needs_force(planned.parts)) {
    models.force = model_in_use(session, planned.trial);
  }
  if (!cancellation::needs_position(planned.parts)) return models;
  for (const stillhand_msgs::FeedthroughModel& model : session.models) {
    if (!model.usable() || !model.to_position() || model.trial() >= planned.trial.number) continue;
    models.position = model.model();
  }
  return models;
}

std::optional<TrialResult::Latency> latency_of(std::vector<double> late_us, double uncertainty_us) {
  if (late_us.empty()) return std::nullopt;
  std::ranges::sort(late_us);
  const auto quantile = [&](double share) {
    return late_us[static_cast<std::size_t>(share * static_cast<double>(late_us.size() - 1))];
  };
  return TrialResult::Latency{quantile(0.5), quantile(0.99), late_us.back(), uncertainty_us};
}

std::optional<TrialResult::Latency> sensor_to_command(const SessionRecording& session,
                                                      const Trial& trial) {
  const ClockLine commanding(session.clock_offsets, "cancellation");
  const ClockLine acquiring(session.clock_offsets, "rig");
  std::vector<double> late_us;
  for (const stillhand_msgs::MotorCommand& command : session.motor_commands) {
    if (!trial.measures(command.tick()) || command.acquired_ns() == 0) continue;
    late_us.push_back(1e-3 *
                      static_cast<double>(commanding.on_experiments_clock(command.stamp_ns()) -
                                          acquiring.on_experiments_clock(command.acquired_ns())));
  }
  return latency_of(std::move(late_us),
                    1e-3 * (commanding.uncertainty_ns() + acquiring.uncertainty_ns()));
}

// Both stamps are the rig's own.
void judge_use(const SessionRecording& session, const Trial& trial, TrialResult& result) {
  std::map<Tick, std::int64_t> acquired_ns;
  for (const stillhand_msgs::RawSample& raw : session.raw_samples) {
    if (trial.measures(raw.tick())) acquired_ns[raw.tick()] = raw.stamp_ns();
  }
  std::vector<double> late_us;
  std::int64_t ticks = 0;
  std::int64_t same = 0;
  for (const stillhand_msgs::RigTruth& truth : session.rig_truths) {
    if (!trial.measures(truth.tick())) continue;
    ++ticks;
    if (truth.motor_tick() == truth.tick()) ++same;
    const auto answered = acquired_ns.extract(truth.motor_tick());  // the first use alone
    if (answered.empty()) continue;
    late_us.push_back(1e-3 * static_cast<double>(truth.stamp_ns() - answered.mapped()));
  }
  if (ticks == 0) return;
  result.same_tick_share = static_cast<double>(same) / static_cast<double>(ticks);
  result.sensor_to_force = latency_of(std::move(late_us), 0.0);
}

std::optional<double> model_lost_s(const TrialOutcome& outcome) {
  for (const Mark& mark : outcome.marks) {
    if (const auto since_s = model_lost_s(mark, outcome.planned.trial)) return since_s;
  }
  return std::nullopt;
}

Excerpt excerpt_of(const std::vector<double>& feedthrough_n, const std::vector<double>& motor_n,
                   const identification::TrackingRecord& record, std::optional<double> lost_s) {
  constexpr auto kTicks = static_cast<std::size_t>(12.0 * kControlRateHz);
  constexpr auto kEvery = static_cast<std::size_t>(kControlRateHz / 100.0);
  constexpr double kBefore_s = 5.0;
  const std::size_t size = feedthrough_n.size();
  const std::size_t latest = size - std::min(kTicks, size);
  const double first_s = std::max(lost_s.value_or(0.0) - kBefore_s, 0.0);
  const std::size_t first = std::min(static_cast<std::size_t>(first_s * kControlRateHz), latest);
  Excerpt out;
  for (std::size_t n = first; n < std::min(first + kTicks, size); n += kEvery) {
    out.time_s.push_back(static_cast<double>(n) * kControlPeriod_s);
    out.feedthrough_n.push_back(feedthrough_n[n]);
    out.motor_n.push_back(motor_n[n]);
    out.target_mm.push_back(1e3 * record.target_m[n]);
    out.cursor_mm.push_back(1e3 * record.cursor_m[n]);
  }
  return out;
}

ForceSignals true_forces(const SessionRecording& session, const Trial& trial) {
  const auto truth = [&](auto value) { return measured(session.rig_truths, trial, value); };
  const double lever_m = rig::StickConfig{}.lever_m;
  return {truth([](const auto& t) { return t.feedthrough_force_n(); }),
          truth([](const auto& t) { return t.motor_force_n(); }),
          truth([](const auto& t) { return t.volitional_force_n(); }),
          truth([&](const auto& t) { return lever_m * t.omega_rad_s(); })};
}

/// The feedthrough is known: of a rig of devices nobody knows it.
bool is_known(const std::vector<double>& feedthrough_n) {
  return std::ranges::all_of(feedthrough_n, [](double each) { return std::isfinite(each); });
}

void judge_cancellation(const SessionRecording& session, const PlannedTrial& planned,
                        const identification::TrackingRecord& record, TrialResult& result) {
  const Trial& trial = planned.trial;
  const ForceSignals forces = true_forces(session, trial);
  result.forces = trial_forces(forces, kControlRateHz);
  if (!planned.moving) return;
  const bool known = is_known(forces.feedthrough_n);
  if (known) result.cancelled_share = cancelled_share(forces.feedthrough_n, forces.motor_n);
  result.excerpt = excerpt_of(forces.feedthrough_n, forces.motor_n, record, result.model_lost_s);
  if (!drives_motor(planned)) return;
  if (known && opposes_feedthrough(planned)) {
    result.counterforce_delay_s =
        counterforce_delay_s(forces.feedthrough_n, forces.motor_n, kControlRateHz);
  }
  result.sensor_to_command = sensor_to_command(session, trial);
  judge_use(session, trial, result);
}

// Eq. SU-19.
double settled_rms_error_mm(const identification::TrackingRecord& record) {
  std::vector<double> error_mm;
  for (std::size_t n = record.cursor_m.size() / 3; n < record.cursor_m.size(); ++n) {
    error_mm.push_back(1e3 * (record.cursor_m[n] - record.target_m[n]));
  }
  return rms(error_mm);
}

TrialResult evaluate_trial(const SessionRecording& session, const TrialOutcome& outcome) {
  const PlannedTrial& planned = outcome.planned;
  TrialResult result{};
  result.model_lost_s = model_lost_s(outcome);
  result.number = planned.trial.number;
  result.label = planned.label;
  identification::TrackingRecord record;
  record.rate_hz = kControlRateHz;
  record.target_m =
      measured(session.tracking_samples, planned.trial, [](const auto& s) { return s.target_m(); });
  record.cursor_m =
      measured(session.tracking_samples, planned.trial, [](const auto& s) { return s.cursor_m(); });
  const double duration_s = static_cast<double>(planned.trial.duration_ticks) * kControlPeriod_s;
  result.metrics = identification::tracking_metrics(record, signal::reference_design(duration_s));
  result.settled_rms_error_mm = settled_rms_error_mm(record);
  result.models = models_of(session, planned);
  judge_cancellation(session, planned, record, result);
  return result;
}

// What holding the 50 Hz model's output would have cost, on the acceleration as it was sensed.
RateConversionCost conversion_cost(const SessionRecording& session,
                                   const stillhand_msgs::FeedthroughModel& message,
                                   const Trial& trial) {
  const identification::FeedthroughModel model = identification::from_idl(message);
  const auto truth =
      measured(session.rig_truths, trial, [](const auto& t) { return t.feedthrough_force_n(); });
  const auto accel_y = [](const auto& s) { return s.accel_y_m_s2(); };
  const auto accel = measured(session.sensed, trial, accel_y);
  const double ratio = kControlRateHz / model.fit.rate_hz;
  // Any message may be in a recording: a rate that is no rate has no cost.
  if (!(ratio >= 1.0 && ratio <= kControlRateHz)) return {NAN, NAN};
  const auto every = static_cast<std::size_t>(ratio);
  std::vector<double> slow_accel;
  for (std::size_t i = 0; i < accel.size(); i += every) slow_accel.push_back(accel[i]);
  const auto fast = signal::simulated(model.control, accel);
  const auto slow = signal::simulated(model.fit, slow_accel);
  std::vector<double> fast_error;
  std::vector<double> held_error;
  std::vector<double> judged;
  // The filters start from rest: their first two seconds are not judged.
  for (auto i = static_cast<std::size_t>(2.0 * kControlRateHz); i < truth.size(); ++i) {
    judged.push_back(truth[i]);
    fast_error.push_back(truth[i] - fast[i]);
    held_error.push_back(truth[i] - slow[i / every]);
  }
  return {rms(fast_error) / rms(judged), rms(held_error) / rms(judged)};
}

// The newest model of the force at that time; nullptr: there was none that is usable.
const stillhand_msgs::FeedthroughModel* identified_before(const SessionRecording& session,
                                                          const Trial& trial) {
  const stillhand_msgs::FeedthroughModel* newest = nullptr;
  for (const stillhand_msgs::FeedthroughModel& model : session.models) {
    if (!model.to_position() && model.from_tick() < trial.start_tick) newest = &model;
  }
  return newest != nullptr && newest->usable() ? newest : nullptr;
}

SensedMotion sensed_motion(const SessionRecording& session, const Trial& trial) {
  const auto accel_y = [](const auto& s) { return s.accel_y_m_s2(); };
  const auto theta = [](const auto& s) { return s.theta_rad(); };
  return {measured(session.sensed, trial, accel_y), measured(session.sensed, trial, theta)};
}

void judge_by_senses(const SessionRecording& session, const std::vector<TrialOutcome>& outcomes,
                     SessionResult& result) {
  const auto moves_alone = [](const TrialOutcome& outcome) {
    return outcome.completed && outcome.planned.trial.phase == TrialPhase::kTracking &&
           outcome.planned.moving && !drives_motor(outcome.planned) &&
           outcome.planned.parts.empty();
  };
  const auto without = std::ranges::find_if(outcomes, moves_alone);
  if (without == outcomes.end()) return;
  const SensedMotion moving = sensed_motion(session, without->planned.trial);
  for (TrialResult& trial : result.trials) {
    const auto outcome = std::ranges::find_if(outcomes, [&](const TrialOutcome& each) {
      return each.planned.trial.number == trial.number;
    });
    if (!drives_motor(outcome->planned)) continue;
    trial.sensed_share =
        sensed_share(moving, sensed_motion(session, outcome->planned.trial), kControlRateHz);
  }
}

// The longest run of measured ticks without a sample.
template <typename Message>
Tick longest_gap(const std::vector<Message>& stream, const Trial& trial) {
  Tick newest = trial.start_tick - 1;
  Tick longest = 0;
  for (const Message& message : stream) {
    if (!trial.measures(message.tick())) continue;
    longest = std::max(longest, message.tick() - newest - 1);
    newest = std::max(newest, message.tick());
  }
  return std::max(longest, trial.start_tick + trial.duration_ticks - newest - 1);
}

// Empty: it was recorded.  A process that stands as long ends a trial, too (apps/lab, Standstill).
std::string why_unrecorded(const SessionRecording& session, const Trial& trial) {
  constexpr Tick kMost_ticks = 1000;
  const bool tracks = trial.phase == TrialPhase::kTracking;
  const Tick gap =
      tracks ? longest_gap(session.tracking_samples, trial) : longest_gap(session.sensed, trial);
  if (gap <= kMost_ticks) return {};
  return fmt::format("the recording lacks {} of its {} ticks in one piece", gap,
                     trial.duration_ticks);
}

void find_disturbances(const SessionRecording& session, const std::vector<TrialOutcome>& outcomes,
                       SessionResult& result) {
  // An older command is not used: deploy/config/rig.yaml, motor.max_motor_age_ticks.
  constexpr double kUnused_s = 0.010;
  for (Miss& miss : misses_in(session, kUnused_s)) {
    const auto hit = std::ranges::find_if(outcomes, [&](const TrialOutcome& each) {
      const Trial& trial = each.planned.trial;
      return each.completed && trial.number == miss.trial &&
             trial.measures(trial.start_tick + ticks_in(miss.trial_s));
    });
    if (hit != outcomes.end()) {
      result.disturbances.push_back({hit->planned.label, std::move(miss)});
    }
  }
}

}  // namespace

SessionResult evaluate(const std::string& recording, const std::vector<TrialOutcome>& outcomes,
                       const std::optional<AnswerConfigs>& answers) {
  const SessionRecording session = read_session(recording);
  SessionResult result;
  result.lost_ticks = session.lost_ticks;
  result.damage = session.damage;
  result.rig_parts = rig_parts_in(session);
  for (const auto& offset : session.clock_offsets) {
    result.clocks[offset.service().c_str()] = offset;
  }
  for (const auto& model : session.models) {
    if (!model.to_position()) result.model = model;
  }
  for (const TrialOutcome& outcome : outcomes) {
    const PlannedTrial& planned = outcome.planned;
    if (!outcome.completed) continue;
    if (std::string why = why_unrecorded(session, planned.trial); !why.empty()) {
      result.unrecorded[planned.trial.number] = std::move(why);
      continue;
    }
    if (planned.trial.phase != TrialPhase::kTracking) continue;
    result.trials.push_back(evaluate_trial(session, outcome));
    TrialResult& trial = result.trials.back();
    if (answers && planned.cancellation && planned.parts.empty()) {
      trial.budget = split_trial(session, planned.trial, *answers).budget;
    }
    const auto* model = identified_before(session, planned.trial);
    if (planned.moving && model != nullptr && !result.conversion) {
      const RateConversionCost cost = conversion_cost(session, *model, planned.trial);
      if (std::isfinite(cost.control_filter)) result.conversion = cost;
    }
  }
  judge_by_senses(session, outcomes, result);
  find_disturbances(session, outcomes, result);
  return result;
}

}  // namespace stillhand::session
