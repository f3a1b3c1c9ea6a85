// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/session_trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "idl/cdr.hpp"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/parts_note.hpp"
#include "services/core/recording/experiment_record.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"
#include "services/messages/recording/named_writers.hpp"

namespace stillhand::measurement {
namespace {

// A hundred days at 1 kHz.  No session has later ticks, and their sums would overflow.
constexpr Tick kMostTicks = 8'640'000'000;

// State of the first pass.
class TrialFinder {
 public:
  void take_sensed(const recording::SampleHead& head) {
    if (head.tick < 0 || head.tick > kMostTicks) return;
    if (samples_ == 0) found_.rig = head.rig;
    if (head.rig != found_.rig) {
      found_.other_rigs = true;
      return;
    }
    ++samples_;
    first_tick_ = std::min(first_tick_, head.tick);
    newest_tick_ = std::max(newest_tick_, head.tick);
    // The trial is known here, because it is announced one second before it begins.
    if (current_ >= 0 && by_number_.at(current_).holds(head.tick)) {
      ++by_number_.at(current_).recorded_ticks;
    }
  }

  void take(const stillhand_msgs::TrialControl& control) {
    const bool runs = control.session() == stillhand_msgs::SESSION_RUNNING &&
                      control.trial() >= 0 && control.phase() != stillhand_msgs::PHASE_IDLE;
    if (!runs) {
      break_off();
      return;
    }
    if (control.start_tick() < 0 || control.start_tick() > kMostTicks ||
        control.duration_ticks() <= 0 || control.duration_ticks() > kMostTicks ||
        control.ramp_ticks() < 0 || control.ramp_ticks() > kMostTicks) {
      return;
    }
    SessionTrial& trial = by_number_[control.trial()];
    if (current_ == control.trial() && trial.trial.start_tick == control.start_tick()) return;
    current_ = control.trial();
    trial = SessionTrial{};
    trial.trial.number = control.trial();
    trial.trial.phase = control.phase() == stillhand_msgs::PHASE_PEGGED ? TrialPhase::kPegged
                        : control.phase() == stillhand_msgs::PHASE_FREE ? TrialPhase::kFree
                                                                        : TrialPhase::kTracking;
    trial.trial.start_tick = control.start_tick();
    trial.trial.duration_ticks = control.duration_ticks();
    trial.trial.ramp_ticks = control.ramp_ticks();
    trial.end_tick = control.start_tick() + control.duration_ticks();
  }

  void take(const stillhand_msgs::TrialAssignment& assignment) {
    // An identification of admittance, on the peg too: no condition and no session's model.
    if (assignment.motion() == stillhand_msgs::MOTION_MULTISINE) {
      perturbed_.insert(assignment.trial());
      return;
    }
    if (!assignment.parts().empty()) {
      names_[assignment.trial()] = assignment.mitigation().c_str();
      return;
    }
    letters_[assignment.trial()] = assignment.motion() == stillhand_msgs::MOTION_STILL ? 'A'
                                   : assignment.cancellation()                         ? 'C'
                                                                                       : 'B';
  }

  void take(const stillhand_msgs::Event& event) {
    const std::string text = event.text().c_str();
    if (device_rig::is_parts_note(event.source().c_str(), text)) parts_[event.rig()] = text;
  }

  SessionTrials finish(const std::string& path) {
    if (samples_ == 0) {
      throw ConfigError(path,
                        "an MCAP file without samples of " + std::string(topics::kSensed.name),
                        "the recording of a Stillhand session, or CSV");
    }
    if (const auto parts = parts_.find(found_.rig); parts != parts_.end()) {
      found_.rig_parts = parts->second;
    }
    for (auto& [number, trial] : by_number_) {
      const auto letter = letters_.find(number);
      if (letter != letters_.end()) trial.letter = letter->second;
      if (trial.trial.phase == TrialPhase::kPegged && !perturbed_.contains(number)) {
        trial.letter = 'I';
      }
      if (const auto name = names_.find(number); name != names_.end()) trial.named = name->second;
      if (trial.trial.phase == TrialPhase::kFree) {
        trial.letter = '?';
        trial.named = "free";
      }
      if (trial.recorded_ticks > 0) found_.trials.push_back(trial);
    }
    if (by_number_.empty()) {
      SessionTrial whole;
      whole.trial.phase = TrialPhase::kTracking;
      whole.trial.start_tick = first_tick_;
      whole.trial.duration_ticks = newest_tick_ - first_tick_ + 1;
      whole.end_tick = newest_tick_ + 1;
      whole.recorded_ticks = samples_;
      found_.trials.push_back(whole);
    }
    return found_;
  }

 private:
  // No trial runs now: the current one was ended early, or had ended before.
  void break_off() {
    if (current_ < 0) return;
    SessionTrial& trial = by_number_.at(current_);
    trial.end_tick = std::min(trial.end_tick, newest_tick_ + 1);
    current_ = -1;
  }

  SessionTrials found_;
  std::map<std::int64_t, SessionTrial> by_number_;
  std::map<std::int64_t, char> letters_;
  std::map<std::uint32_t, std::string> parts_;  ///< of each rig
  std::map<std::int64_t, std::string> names_;   ///< of mitigations
  std::set<std::int64_t> perturbed_;
  std::int64_t current_ = -1;
  std::int64_t samples_ = 0;
  Tick first_tick_ = std::numeric_limits<Tick>::max();
  Tick newest_tick_ = -1;
};

std::string all_names(const std::vector<SessionTrial>& trials, const SessionTrial* except) {
  std::string text;
  for (const SessionTrial& trial : trials) {
    if (&trial != except) text += (text.empty() ? "" : ", ") + trial.name();
  }
  return text;
}

bool answers_to(const SessionTrial& trial, const std::string& wanted) {
  return wanted == std::string(1, trial.letter) || (!wanted.empty() && wanted == trial.named) ||
         wanted == std::to_string(trial.trial.number);
}

// Identification before tracking, then by length.
bool less_wanted(const SessionTrial& a, const SessionTrial& b) {
  const auto rank = [](const SessionTrial& trial) {
    return std::pair(trial.trial.phase == TrialPhase::kPegged, trial.recorded_ticks);
  };
  return rank(a) < rank(b);
}

}  // namespace

std::string SessionTrial::name() const {
  const double length_s = static_cast<double>(end_tick - trial.start_tick) * kControlPeriod_s;
  if (blinded) {
    return fmt::format("{} ({:.4g} s)", trial.number, length_s);
  }
  return fmt::format("{} ({}, {:.4g} s)", trial.number,
                     named.empty() ? std::string(1, letter) : named, length_s);
}

SessionTrials find_trials(recording::McapReader& reader, const std::string& path) {
  TrialFinder finder;
  recording::MessageFilter filter;
  filter.topics = {std::string(topics::kSensed.name), std::string(topics::kTrialControl.name),
                   std::string(topics::kTrialAssignment.name), std::string(topics::kEvent.name)};
  const recording::Status status =
      recording::for_each_session_message(reader, filter, [&](const recording::MessageView& view) {
        if (view.channel.topic == topics::kSensed.name) {
          finder.take_sensed(recording::sample_head(view.bytes));
        } else if (view.channel.topic == topics::kTrialControl.name) {
          stillhand_msgs::TrialControl control;
          if (from_cdr(view.bytes, control)) finder.take(control);
        } else if (view.channel.topic == topics::kEvent.name) {
          stillhand_msgs::Event event;
          if (from_cdr(view.bytes, event)) finder.take(event);
        } else {
          stillhand_msgs::TrialAssignment assignment;
          if (from_cdr(view.bytes, assignment)) finder.take(assignment);
        }
        return true;
      });
  SessionTrials found = finder.finish(path);
  if (!status.ok()) found.broken = status.text;
  const bool of_experiment = reader.find_metadata(recording::kExperimentRecord) != nullptr;
  for (SessionTrial& trial : found.trials) {
    trial.blinded = of_experiment && trial.trial.phase == TrialPhase::kTracking;
  }
  return found;
}

const SessionTrial& choose(const SessionTrials& trials, const std::string& wanted,
                           const std::string& path, bool last) {
  if (trials.trials.empty()) {
    throw ConfigError(path, "a session without a recorded trial", "at least one trial");
  }
  if (wanted.empty()) return *std::ranges::max_element(trials.trials, less_wanted);
  // To --trial a blinded one answers by its number alone: its condition would find it.
  const auto answers = [&](const SessionTrial& trial) {
    return last || !trial.blinded ? answers_to(trial, wanted)
                                  : wanted == std::to_string(trial.trial.number);
  };
  const auto count = std::ranges::count_if(trials.trials, answers);
  if (last ? count > 0 : count == 1) {
    return *std::find_if(trials.trials.rbegin(), trials.trials.rend(), answers);
  }
  throw ConfigError(last ? path : "--trial",
                    wanted + (count == 0 ? "" : ", which matches several trials"),
                    "one of " + all_names(trials.trials, nullptr) + " in " + path);
}

std::vector<std::string> notes_of(const SessionTrials& trials, const SessionTrial& chosen) {
  std::vector<std::string> notes;
  if (chosen.trial.number < 0) {
    notes.emplace_back("The recording announces no trial; it is read as a whole.");
  } else {
    const std::string others = all_names(trials.trials, &chosen);
    notes.push_back("Trial " + chosen.name() + " of the session" +
                    (others.empty() ? "." : "; there are also " + others + "."));
    if (chosen.end_tick < chosen.trial.start_tick + chosen.trial.duration_ticks) {
      notes.push_back(fmt::format("The trial was ended early, after {} of {} ticks.",
                                  chosen.end_tick - chosen.trial.start_tick,
                                  chosen.trial.duration_ticks));
    }
  }
  if (!trials.rig_parts.empty()) notes.push_back("The " + trials.rig_parts + ".");
  if (trials.other_rigs) {
    notes.push_back("Rig " + std::to_string(trials.rig) + "; samples of other rigs are left out.");
  }
  if (!trials.broken.empty()) notes.push_back("Reading ended early: " + trials.broken + ".");
  return notes;
}

}  // namespace stillhand::measurement
