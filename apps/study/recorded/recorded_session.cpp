// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/recorded_session.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "apps/libraries/measurement/session_trials.hpp"
#include "apps/libraries/session/measured_ticks.hpp"
#include "apps/libraries/session/session_recording.hpp"
#include "apps/study/recorded/model_in_use.hpp"
#include "apps/study/subjects/trial_analysis.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/vehicle/driven_motion.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::study {
namespace {

using measurement::SessionTrial;
using session::SessionRecording;

measurement::SessionTrials trials_of(const SessionFile& file) {
  recording::FileSource source(file.path.string());
  recording::McapReader reader(source);
  measurement::SessionTrials found = measurement::find_trials(reader, file.path.string());
  // No experiment is read before it is unblinded.
  for (measurement::SessionTrial& trial : found.trials) trial.blinded = false;
  return found;
}

bool ended_early(const SessionTrial& trial) {
  return trial.end_tick < trial.trial.start_tick + trial.trial.duration_ticks;
}

double lost_share(const SessionTrial& trial) {
  return 1.0 - static_cast<double>(trial.recorded_ticks) /
                   static_cast<double>(trial.trial.duration_ticks);
}

// Why the trial cannot count, or empty.
std::string incomplete(const SessionTrial& trial, double least_share) {
  const Tick planned = trial.trial.duration_ticks;
  if (ended_early(trial)) return "was ended early";
  if (static_cast<double>(trial.recorded_ticks) < least_share * static_cast<double>(planned)) {
    return fmt::format("has {} of {} samples", trial.recorded_ticks, planned);
  }
  return "";
}

// Samples of other rigs, and those that hold an earlier value, go.
void keep_valid(SessionRecording& recorded, std::uint32_t rig) {
  constexpr Flags kNotMeasured = Flag::kInputInvalid | Flag::kFault;
  std::erase_if(recorded.sensed, [&](const auto& m) {
    return m.rig() != rig || (m.flags() & kNotMeasured) != 0 ||
           !std::isfinite(m.accel_y_m_s2() + m.force_n());
  });
  std::erase_if(recorded.tracking_samples, [&](const auto& m) {
    return m.rig() != rig || !std::isfinite(m.target_m() + m.cursor_m());
  });
  std::erase_if(recorded.rig_truths, [&](const auto& m) { return m.rig() != rig; });
  // The canceller does not take them.
  std::erase_if(recorded.models, [](const auto& m) { return !m.usable() || m.to_position(); });
}

template <typename Message, typename Value>
std::vector<double> kept(const std::vector<Message>& stream, const Trial& trial, Tick every,
                         double least_share, Value value) {
  std::int64_t missing = 0;
  const std::vector<double> all = session::measured(stream, trial, value, &missing);
  if (static_cast<double>(missing) >
      (1.0 - least_share) * static_cast<double>(trial.duration_ticks)) {
    throw ConfigError("trial " + std::to_string(trial.number),
                      fmt::format("{} of {} samples missing", missing, trial.duration_ticks),
                      "a trial without gaps");
  }
  std::vector<double> out;
  for (std::size_t n = 0; n < all.size(); n += static_cast<std::size_t>(every)) {
    out.push_back(all[n]);
  }
  return out;
}

Identification identified_from(const SessionRecording& recorded, const Trial& trial,
                               double least_share) {
  identification::Record pegged;
  pegged.rate_hz = kControlRateHz;
  pegged.acceleration_m_s2 =
      kept(recorded.sensed, trial, 1, least_share, [](const auto& m) { return m.accel_y_m_s2(); });
  pegged.force_n =
      kept(recorded.sensed, trial, 1, least_share, [](const auto& m) { return m.force_n(); });
  return identified(pegged);
}

TrackedTrial tracked_from(const SessionRecording& recorded, const SessionTrial& found,
                          double least_share) {
  const auto of = [&](const auto& stream, auto value) {
    return kept(stream, found.trial, kKeepEvery, least_share, value);
  };
  session::TrialSignals signals;
  signals.tracking.rate_hz = kControlRateHz / static_cast<double>(kKeepEvery);
  signals.tracking.target_m =
      of(recorded.tracking_samples, [](const auto& m) { return m.target_m(); });
  signals.tracking.cursor_m =
      of(recorded.tracking_samples, [](const auto& m) { return m.cursor_m(); });
  // The truth of a simulated rig; of a rig of devices the feedthrough is not known, and is NaN.
  signals.feedthrough_n =
      of(recorded.rig_truths, [](const auto& m) { return m.feedthrough_force_n(); });
  signals.motor_n = of(recorded.rig_truths, [](const auto& m) { return m.motor_force_n(); });
  session::PlannedTrial planned{};
  planned.trial = found.trial;
  planned.cancellation = found.letter == 'C';
  if (!found.named.empty()) {  // a mitigation; read_recorded_session() knows it
    planned.parts = session::row_of(*session::condition_named(found.named)).parts;
  }
  return evaluated(signals, planned);
}

// What an experiment announces before a trial (apps/experiment/README.md).
struct Announced {
  bool practice = false;
  std::int64_t block = 0;
  std::int64_t place = 0;
};

// The whole number behind these words, if there is one.
std::optional<std::int64_t> number_after(std::string_view text, std::string_view words) {
  const std::size_t at = text.find(words);
  if (at == std::string_view::npos) return std::nullopt;
  text.remove_prefix(at + words.size());
  std::int64_t number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  return read.ec == std::errc() ? std::optional(number) : std::nullopt;
}

// Trials whose motion the stick made: their condition B is not that of a ride.
std::set<std::int64_t> driven_in(const SessionRecording& recorded) {
  std::set<std::int64_t> out;
  for (const auto& event : recorded.events) {
    if (event.kind() != stillhand_msgs::EVENT_NOTE) continue;
    if (const auto number = number_after(event.text().c_str(), vehicle::kDrivenEvent)) {
      out.insert(*number);
    }
  }
  return out;
}

// "experiment: trial 4, practice" or "experiment: trial 4, block 1, place 2, label X", by number.
std::map<std::int64_t, Announced> announced_in(const SessionRecording& recorded) {
  std::map<std::int64_t, Announced> out;
  for (const auto& event : recorded.events) {
    if (event.kind() != stillhand_msgs::EVENT_NOTE || event.source() != "experiment") continue;
    const std::string_view text = event.text().c_str();
    const auto number = number_after(text, "experiment: trial ");
    if (!number) continue;
    const auto block = number_after(text, ", block ");
    const auto place = number_after(text, ", place ");
    const bool practice = text.ends_with(", practice");
    if (practice || (block && place)) {
      out[*number] = {practice, block.value_or(0), place.value_or(0)};
    }
  }
  return out;
}

}  // namespace

RecordedSession read_recorded_session(const SessionFile& file, double least_share) {
  const measurement::SessionTrials trials = trials_of(file);
  SessionRecording recorded = session::read_session(file.path.string());
  RecordedSession out;
  keep_valid(recorded, trials.rig);
  out.rig_parts = trials.rig_parts;
  // A person's hand is a pointer of the screen, or a stick whose angle a device measures.
  const bool real_stick = out.rig_parts.find("angle") < out.rig_parts.find("simulated:");
  out.simulated = !recorded.operator_forces.empty() && recorded.pointers.empty() && !real_stick;
  const std::map<std::int64_t, Announced> announced = announced_in(recorded);
  const std::set<std::int64_t> driven = driven_in(recorded);
  for (const SessionTrial& trial : trials.trials) {
    const std::string where =
        fmt::format("{}, session {}, trial {}", file.participant, file.session, trial.name());
    if (trial.trial.phase == TrialPhase::kFree) continue;  // an identification
    const std::optional<Condition> condition = condition_in(recorded, trial, trials.rig);
    std::string why = !condition ? "has no condition" : incomplete(trial, least_share);
    if (why.empty()) {
      why = other_model_in(recorded, trial, trials.rig);
      if (!why.empty()) out.other_model.insert(trial.trial.number);
    }
    if (why.empty() && driven.contains(trial.trial.number)) why = "was driven by the stick";
    const auto note = announced.find(trial.trial.number);
    const Announced plan = note == announced.end() ? Announced{} : note->second;
    const bool practised = plan.practice;
    try {
      if (!why.empty()) {
      } else if (trial.letter == 'I') {
        out.identification = identified_from(recorded, trial.trial, least_share);
        out.identify_s = static_cast<double>(trial.trial.duration_ticks) * kControlPeriod_s;
        out.pegged.push_back({file.participant, file.session, trial.trial.number});
      } else {
        if (condition == kCPlus && adds_nothing(recorded, trial, trials.rig)) {
          out.plus_adds_nothing = true;
        }
        (practised ? out.practice : out.trials)
            .push_back({file.participant, file.session, trial.trial.number, 0, *condition,
                        tracked_from(recorded, trial, least_share), lost_share(trial), plan.block,
                        plan.place});
      }
    } catch (const ConfigError& error) {
      why = error.what();
    }
    if (ended_early(trial) && trial.letter != 'I' && !practised) ++out.broken_trials;
    if (!why.empty() && !practised) out.left_out.push_back(fmt::format("{}: {}", where, why));
  }
  return out;
}

}  // namespace stillhand::study
