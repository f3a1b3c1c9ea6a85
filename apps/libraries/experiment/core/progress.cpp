// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/core/progress.hpp"

#include <fmt/format.h>

#include "services/core/contract/config_error.hpp"

namespace stillhand::experiment {

const Step& Progress::step_of(const Entry& entry, StepKind kind) const {
  const bool there = entry.step >= 0 && entry.step < static_cast<std::int64_t>(plan_.size());
  if (!there || plan_[static_cast<std::size_t>(entry.step)].kind != kind) {
    throw ConfigError("step", fmt::to_string(entry.step),
                      "a step of this experiment's plan: the journal was changed by hand, or is of "
                      "another experiment");
  }
  return plan_[static_cast<std::size_t>(entry.step)];
}

void Progress::take_trial(const Entry& entry) {
  if (entry.step < 0) return;  // identification
  const auto step = static_cast<std::size_t>(entry.step);
  const bool practice = step < plan_.size() && plan_[step].kind == StepKind::kPractice;
  if (!practice) step_of(entry, StepKind::kTrial);
  if (!entry.completed) return;  // it is run again
  if (practice) {
    practice_.push_back(entry.dwell_ratio.value_or(0.0));
    in_a_row_ = practice_.back() >= design_.practice.dwell_ratio ? in_a_row_ + 1 : 0;
    reached_ = reached_ || in_a_row_ >= design_.practice.in_a_row;
    if (reached_ || practice_trials() >= design_.practice.most_trials) done_.insert(step);
    return;
  }
  done_.insert(step);
  last_trial_ = step;
}

void Progress::take(const Entry& entry) {
  switch (entry.kind) {
    case EntryKind::kSessionBegan:
      if (entry.session != sessions_ + 1) {
        throw ConfigError("session", fmt::to_string(entry.session),
                          fmt::format("{}: sessions are counted from 1", sessions_ + 1));
      }
      sessions_ = entry.session;
      session_open_ = true;
      digests_.insert(entry.digest);
      return;
    case EntryKind::kSessionEnded:
      session_open_ = false;
      return;
    case EntryKind::kTrialEnded:
      return take_trial(entry);
    case EntryKind::kQuestionAnswered:
      step_of(entry, StepKind::kQuestion);
      done_.insert(static_cast<std::size_t>(entry.step));
      return;
    case EntryKind::kBreakOver:
      step_of(entry, StepKind::kBreak);
      done_.insert(static_cast<std::size_t>(entry.step));
      return;
    case EntryKind::kRepeatAsked:
      step_of(entry, StepKind::kTrial);
      done_.erase(static_cast<std::size_t>(entry.step));
      ++repeats_;
      return;
    case EntryKind::kExcluded:
      excluded_ = entry.text;
      return;
    case EntryKind::kTrialBegan:
    case EntryKind::kNote:
    case EntryKind::kUnblinded:
      return;
  }
}

std::optional<std::size_t> Progress::next() const {
  for (std::size_t step = 0; step < plan_.size(); ++step) {
    if (!done_.contains(step)) return step;
  }
  return std::nullopt;
}

std::int64_t Progress::trials_done() const {
  std::int64_t count = 0;
  for (const std::size_t step : done_) count += plan_[step].kind == StepKind::kTrial ? 1 : 0;
  return count;
}

}  // namespace stillhand::experiment
