// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/recorded_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "apps/measurement/session_trials.hpp"
#include "apps/session/measured_ticks.hpp"
#include "apps/session/session_recording.hpp"
#include "apps/study/trial_analysis.hpp"
#include "services/contract/config_error.hpp"
#include "services/contract/flag.hpp"
#include "services/recording/core/mcap/mcap_reader.hpp"
#include "services/recording/file_io.hpp"

namespace stillhand::study {
namespace {

using measurement::SessionTrial;
using session::SessionRecording;

measurement::SessionTrials trials_of(const SessionFile& file) {
  recording::FileSource source(file.path.string());
  recording::McapReader reader(source);
  return measurement::find_trials(reader, file.path.string());
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
}

template <typename Message, typename Value>
std::vector<double> kept(const std::vector<Message>& stream, const Trial& trial, Tick every,
                         double least_share, Value value) {
  std::int64_t missing = 0;
  const std::vector<double> all = session::measured(stream, trial, value, missing);
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
  planned.label = found.letter;
  planned.cancellation = found.letter == 'C';
  return evaluated(signals, planned);
}

// The trials that an experiment announced as practice, by a note before each
// (apps/experiment/README.md).
std::set<std::int64_t> practice_of(const SessionRecording& recorded) {
  std::set<std::int64_t> numbers;
  for (const auto& event : recorded.events) {
    constexpr std::string_view kBegin = "experiment: trial ";
    const std::string text = event.text().c_str();
    const bool note = event.kind() == stillhand_msgs::EVENT_NOTE && event.source() == "experiment";
    if (!note || !text.starts_with(kBegin) || !text.ends_with(", practice")) continue;
    std::int64_t number = -1;
    const char* digits = text.data() + kBegin.size();
    if (std::from_chars(digits, text.data() + text.size(), number).ec == std::errc()) {
      numbers.insert(number);
    }
  }
  return numbers;
}

}  // namespace

RecordedSession read_recorded_session(const SessionFile& file, double least_share) {
  const measurement::SessionTrials trials = trials_of(file);
  SessionRecording recorded = session::read_session(file.path.string());
  RecordedSession out;
  out.control_model = !recorded.control_models.empty();
  keep_valid(recorded, trials.rig);
  const std::set<std::int64_t> practice = practice_of(recorded);
  for (const SessionTrial& trial : trials.trials) {
    const std::string where =
        fmt::format("{}, session {}, trial {}", file.participant, file.session, trial.name());
    std::string why = trial.letter == '?' ? "has no condition" : incomplete(trial, least_share);
    const bool practised = practice.contains(trial.trial.number);
    try {
      if (!why.empty()) {
      } else if (trial.letter == 'I') {
        out.identification = identified_from(recorded, trial.trial, least_share);
        out.identify_s = static_cast<double>(trial.trial.duration_ticks) * kControlPeriod_s;
      } else {
        (practised ? out.practice : out.trials)
            .push_back({file.participant, file.session, trial.trial.number, 0, trial.letter,
                        tracked_from(recorded, trial, least_share), lost_share(trial)});
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
