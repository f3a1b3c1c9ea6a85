// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/summary_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "apps/libraries/report/or_null.hpp"
#include "apps/libraries/session/force_budget_json.hpp"
#include "apps/libraries/session/misses_json.hpp"
#include "apps/libraries/session/numbers_json.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/core/vehicle/vehicle_settings.hpp"
#include "services/files/settings/load.hpp"
#include "version.hpp"

namespace stillhand::lab {
namespace {

using nlohmann::ordered_json;
using report::or_null;

// The study's shape with one subject: a standard deviation needs two.
ordered_json condition_json(const session::TrialResult& trial) {
  ordered_json condition;
  for (const session::Number& number : session::numbers(session::kLab)) {
    const double value = number.of(trial);
    if (number.shape == session::Shape::kSample) {
      condition[number.key] = {{"mean", or_null(value)},
                               {"std", nullptr},
                               {"per_subject", ordered_json::array({or_null(value)})}};
    } else if (std::isfinite(value) || number.still != session::Still::kLeftOut) {
      condition[number.key] = or_null(value);
    }
  }
  if (trial.sensed_share) {
    condition["cancelled_share_sensed"] = {
        {"mean", trial.sensed_share->share},
        {"interval95", {trial.sensed_share->low, trial.sensed_share->high}}};
  }
  const auto put_latency = [&condition](const char* key, const auto& latency) {
    if (!latency) return;
    condition[key] = {{"p50", latency->p50_us},
                      {"p99", latency->p99_us},
                      {"max", latency->max_us},
                      {"uncertainty", latency->uncertainty_us}};
  };
  put_latency("sensor_to_command_us", trial.sensor_to_command);
  put_latency("sensor_to_force_us", trial.sensor_to_force);
  if (trial.same_tick_share) condition["same_tick_share"] = *trial.same_tick_share;
  return condition;
}

ordered_json clocks_json(const session::SessionResult& result) {
  ordered_json clocks = ordered_json::object();
  for (const auto& [service, offset] : result.clocks) {
    clocks[service] = {{"same_clock", offset.same_clock()},
                       {"offset_s", 1e-9 * static_cast<double>(offset.offset_ns())},
                       {"uncertainty_us", 1e-3 * offset.uncertainty_ns()},
                       {"drift_ppm", or_null(offset.drift_ppm())},
                       {"drift_sigma_ppm", or_null(offset.drift_sigma_ppm())},
                       {"round_trip_us", 1e-3 * static_cast<double>(offset.round_trip_ns())},
                       {"steps", offset.steps()}};
  }
  return clocks;
}

ordered_json disturbed_json(const session::SessionResult& result, std::int64_t trial) {
  ordered_json list = ordered_json::array();
  for (const auto& [label, miss] : result.disturbances) {
    if (miss.trial == trial) list.push_back(session::json_of(miss));
  }
  return list;
}

// Of a trial that was evaluated; null: its motor does not cancel, or nobody knows the feedthrough.
void add_cancelling(const session::SessionResult& result, std::int64_t number, ordered_json& json) {
  const auto trial = std::ranges::find(result.trials, number, &session::TrialResult::number);
  const bool there = trial != result.trials.end();
  json["lateness"] = there ? session::budget_json(trial->budget) : nullptr;
  json["model"] = there ? or_null(trial->models.force) : nullptr;
}

ordered_json restoration_json(const session::SessionResult& result, session::Condition label) {
  return session::of_each_metric(&session::Number::name, [&](std::size_t k) {
    return or_null(restoration_of(result, session::kMetrics[k], label));
  });
}

// Every condition with motion but B, C and the mitigations, as the study's table has them.
ordered_json mitigations_json(const session::SessionResult& result) {
  std::vector<const session::TrialResult*> shown = mitigated_trials(result);
  if (shown.empty()) return ordered_json::object();
  if (const session::TrialResult* c = trial_of(result, session::Condition::kC))
    shown.insert(shown.begin(), c);
  ordered_json json = ordered_json::object();
  for (const session::TrialResult* trial : shown) {
    ordered_json& one = json[session::name_of(trial->label)];
    one = {
        {"restored", or_null(settled_restoration_of(result, trial->label))},
        {"settled_rms_error_mm", or_null(trial->settled_rms_error_mm)},
        {"motor_n", or_null(trial->forces.motor_n)},
        {"volitional_n", or_null(trial->forces.volitional_n)},
        {"models",
         {{"force", or_null(trial->models.force)}, {"position", or_null(trial->models.position)}}},
        {"restoration", restoration_json(result, trial->label)}};
  }
  return json;
}

// The stick drove: no motion was asked.
ordered_json vehicle_json(const LabOptions& options) {
  const auto settings =
      settings::load<vehicle::VehicleSettings>(options.config / "vehicle.yaml", "vehicle");
  const vehicle::VehicleConfig driven =
      vehicle::driven_config({}, settings, options.vehicle).vehicle;
  return {{"kind", "vehicle"},
          {"vehicle", options.vehicle},
          {"gain_m_s2_rad", driven.gain_m_s2_rad},
          {"delay_s", driven.delay_s}};
}

// Motion that the trial asked of the platform; null: none.
ordered_json motion_json(const session::TrialOutcome& outcome, const LabOptions& options) {
  const session::ProtocolOptions& protocol = options.protocol;
  const bool tracks = outcome.planned.trial.phase == TrialPhase::kTracking;
  if (!options.vehicle.empty() && outcome.planned.moving && tracks) return vehicle_json(options);
  if (!outcome.asked) return nullptr;
  const motion::MotionReport& asked = *outcome.asked;
  ordered_json json{{"kind", "noise"},
                    {"rms_m_s2", asked.rms_m_s2},
                    {"peak_m_s2", asked.peak_m_s2},
                    {"peak_position_m", asked.peak_position_m}};
  if (outcome.planned.motion == motion::MotionKind::kRoad) {
    json["kind"] = "road";
    json["road_class"] = protocol.road_class;
    json["speed_m_s"] = protocol.road_speed_m_s;
  } else if (outcome.planned.motion == motion::MotionKind::kMultisine) {
    json["kind"] = "interleaved multisines";
    json["period_s"] = protocol.perturb_period_s;
  } else if (outcome.planned.motion == motion::MotionKind::kRide) {
    json["kind"] = "ride";
    json["corner_hz"] = asked.corner_hz;
    json["removed_share"] = asked.removed_share;
    json["removed_slow_share"] = asked.removed_slow_share;
  }
  return json;
}

ordered_json trial_json(const session::TrialOutcome& outcome, const LabOptions& options) {
  ordered_json marks = ordered_json::array();
  for (const session::Mark& mark : outcome.marks) {
    marks.push_back({{"what", mark.what},
                     {"source", mark.source},
                     {"topic", mark.topic},
                     {"peer", mark.peer},
                     {"text", mark.text},
                     {"first_tick", mark.first_tick},
                     {"count", mark.count},
                     {"worst_us", mark.worst_us}});
  }
  const Trial& trial = outcome.planned.trial;
  return {{"number", trial.number},
          {"condition", session::name_of(outcome.planned.label)},
          {"start_tick", trial.start_tick},
          {"duration_ticks", trial.duration_ticks},
          {"motion", motion_json(outcome, options)},
          {"completed", outcome.completed},
          {"aborted", or_null(outcome.aborted)},
          {"deadline_misses", outcome.misses.deadline},
          {"cycle_misses", outcome.misses.cycle},
          {"lost_ticks", outcome.misses.lost_ticks},
          {"marks", marks}};
}

// What the rig was made of: no result of a simulated part may pass for one of a real one.
ordered_json rig_json(const LabOptions& options) {
  if (options.devices.empty()) return {{"kind", "simulated"}};
  const auto devices = settings::load<device_rig::DevicesConfig>(options.devices, "devices");
  ordered_json parts = ordered_json::object();
  for (const auto& [signal, part] : device_rig::named_parts(devices.signals)) parts[signal] = part;
  return {{"kind", "devices"}, {"parts", parts}};
}

ordered_json identification_json(const session::SessionResult& result) {
  if (!result.model) return nullptr;
  const auto& model = *result.model;
  ordered_json json{{"usable", model.usable()},
                    {"text", model.text().c_str()},
                    {"heldout_vaf_percent", or_null(model.heldout_vaf_percent())},
                    {"heldout_rmse_n", or_null(model.heldout_rmse_n())},
                    {"conversion_error", or_null(model.conversion_error())}};
  if (result.conversion) {
    json["residual_share"] = {
        {"filter_at_1_khz", or_null(result.conversion->control_filter)},
        {"zero_order_hold_of_50_hz", or_null(result.conversion->zero_order_hold)}};
  }
  return json;
}

// (B - X)/(B - A) of a value of a trial.
std::optional<double> restored(const session::SessionResult& result, session::Condition label,
                               auto value) {
  const session::TrialResult* a = trial_of(result, session::Condition::kA);
  const session::TrialResult* b = trial_of(result, session::Condition::kB);
  const session::TrialResult* x = trial_of(result, label);
  if (a == nullptr || b == nullptr || x == nullptr) return std::nullopt;
  return (value(*b) - value(*x)) / (value(*b) - value(*a));
}

}  // namespace

bool simulated_subject(const LabOptions& options) {
  if (options.who != Operator::kSimulated || options.devices.empty()) {
    return options.who == Operator::kSimulated;
  }
  return settings::load<device_rig::DevicesConfig>(options.devices, "devices").signals.angle ==
         "simulated";
}

const session::TrialResult* trial_of(const session::SessionResult& result,
                                     session::Condition label) {
  const session::TrialResult* newest = nullptr;
  for (const session::TrialResult& trial : result.trials) {
    if (trial.label == label) newest = &trial;
  }
  return newest;
}

std::optional<double> restoration_of(const session::SessionResult& result,
                                     const session::Number& number, session::Condition label) {
  return restored(result, label,
                  [&](const session::TrialResult& trial) { return number.of(trial); });
}

std::vector<const session::TrialResult*> mitigated_trials(const session::SessionResult& result) {
  std::vector<const session::TrialResult*> out;
  if (const session::TrialResult* plus = trial_of(result, session::Condition::kCPlus))
    out.push_back(plus);
  for (const session::Condition each : session::conditions_of(session::kLabConditions)) {
    const session::TrialResult* trial = trial_of(result, each);
    if (trial != nullptr && session::is_mitigation(each)) out.push_back(trial);
  }
  return out;
}

std::optional<double> settled_restoration_of(const session::SessionResult& result,
                                             session::Condition label) {
  return restored(result, label, std::mem_fn(&session::TrialResult::settled_rms_error_mm));
}

std::vector<std::string> disturbance_lines(const session::SessionResult& result) {
  constexpr std::size_t kMost = 5;
  std::vector<session::Disturbance> worst = result.disturbances;
  std::ranges::stable_sort(worst, std::greater(),
                           [](const session::Disturbance& each) { return each.miss.late_s; });
  // The longest of each trial first: every mark of a figure has its line.
  std::set<session::Condition> had;
  std::stable_partition(worst.begin(), worst.end(), [&](const session::Disturbance& each) {
    return had.insert(each.label).second;
  });
  if (worst.size() > kMost) worst.resize(std::max(kMost, had.size()));
  std::ranges::stable_sort(worst, {},
                           [](const session::Disturbance& each) { return each.miss.from_ns; });
  std::vector<std::string> lines;
  lines.reserve(worst.size() + 1);
  for (const auto& [label, miss] : worst) {
    lines.push_back(fmt::format("{} disturbed at {:.1f} s: {}", session::in_words(label),
                                miss.trial_s, session::what_happened(miss)));
  }
  if (const std::size_t more = result.disturbances.size() - worst.size(); more > 0) {
    lines.push_back(fmt::format(
        "{} shorter ones: `stillhand misses --least-ms 10 session.mcap` lists them", more));
  }
  return lines;
}

std::string name_in(const session::SessionResult& result, const session::TrialResult& trial) {
  const std::string name = session::name_of(trial.label);
  const bool once =
      std::ranges::count(result.trials, trial.label, &session::TrialResult::label) == 1;
  return once ? name : fmt::format("{} of trial {}", name, trial.number);
}

std::vector<std::string> model_change_lines(const std::vector<session::TrialOutcome>& outcomes) {
  std::vector<std::string> lines;
  for (const session::TrialOutcome& outcome : outcomes) {
    for (const session::Mark& mark : outcome.marks) {
      std::string line = session::model_change(mark, outcome.planned.trial);
      if (line.empty()) continue;
      lines.push_back(session::in_words(outcome.planned.label) + ": " + std::move(line));
    }
  }
  return lines;
}

std::vector<std::string> uncounted_lines(const std::vector<session::TrialOutcome>& outcomes) {
  std::vector<std::string> lines;
  for (const session::TrialOutcome& outcome : outcomes) {
    if (outcome.completed) continue;
    lines.push_back(fmt::format("trial {}, {}, does not count: {}", outcome.planned.trial.number,
                                session::in_words(outcome.planned.label), outcome.aborted));
  }
  return lines;
}

ordered_json summary_json(const LabOptions& options,
                          const std::vector<session::TrialOutcome>& outcomes,
                          const session::SessionResult& result, bool interrupted) {
  ordered_json summary;
  summary["conditions"] = ordered_json::object();
  for (const auto label : session::kPaperConditions) {
    if (const session::TrialResult* trial = trial_of(result, label)) {
      summary["conditions"][session::name_of(label)] = condition_json(*trial);
    }
  }
  for (const session::TrialResult* trial : mitigated_trials(result)) {
    summary["conditions"][session::name_of(trial->label)] = condition_json(*trial);
  }
  // Tests over subjects need subjects; a lab session has one.
  summary["t_tests"] = nullptr;
  summary["manova"] = nullptr;
  summary["restoration"] = restoration_json(result, session::Condition::kC);
  if (const ordered_json mitigations = mitigations_json(result); !mitigations.empty()) {
    summary["mitigations"] = mitigations;
  }
  summary["identification"] = identification_json(result);
  summary["rig"] = rig_json(options);
  summary["control_model"] = or_null(options.model.string());
  summary["canceller"] = options.canceller;
  summary["trials"] = ordered_json::array();
  for (const session::TrialOutcome& outcome : outcomes) {
    summary["trials"].push_back(trial_json(outcome, options));
    summary["trials"].back()["disturbed"] = disturbed_json(result, outcome.planned.trial.number);
    add_cancelling(result, outcome.planned.trial.number, summary["trials"].back());
  }
  summary["lost_ticks"] = result.lost_ticks;
  summary["clocks"] = clocks_json(result);
  summary["recording_damage"] = result.damage;
  summary["interrupted"] = interrupted;
  summary["seed"] = options.protocol.seed;
  summary["subject"] = options.subject;
  summary["operator"] = simulated_subject(options) ? "simulated" : "person";
  summary["trial_seconds"] = options.protocol.trial_s;
  summary["identify_seconds"] = options.protocol.identify_s;
  summary["reference_note"] =
      options.protocol.trial_s == 180.0
          ? "harmonics of 1/180 Hz as printed in the paper"
          : "the fifteen frequencies sit on harmonics of the trial's own length";
  summary["version"] = kVersion;
  return summary;
}

}  // namespace stillhand::lab
