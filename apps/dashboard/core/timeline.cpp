// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/timeline.hpp"

#include <algorithm>

#include "services/core/contract/time_difference.hpp"

namespace stillhand::dashboard {

namespace {

bool counts_more(const Mark& one, const Mark& held) {
  if (one.level != held.level) return one.level > held.level;
  if (one.waits_for == held.waits_for) return one.amount > held.amount;
  const bool first = one.waits_for < held.waits_for;
  const double cause = first ? one.amount : held.amount;
  const double other = first ? held.amount : one.amount;
  return (cause >= 0.5 * other) == first;
}

}  // namespace

void Timeline::mark(MarkKind kind, Mark mark) {
  const std::int64_t length_ns = std::max<std::int64_t>(difference_ns(end_ns_, begin_ns_), kParts);
  const std::int64_t since_ns = difference_ns(mark.at_ns, begin_ns_);
  const std::int64_t part = std::clamp<std::int64_t>(since_ns / (length_ns / kParts), 0, kParts);
  const auto [place, first] = marks_.try_emplace({kind, part}, mark);
  if (first) return;
  Mark& held = place->second;
  mark.count += held.count;
  mark.at_ns = std::min(mark.at_ns, held.at_ns);
  if (counts_more(mark, held)) {
    held = std::move(mark);
  } else {
    held.count = mark.count;
    held.at_ns = mark.at_ns;
  }
}

void Timeline::announce(const Trial& trial, std::int64_t at_ns) {
  if (announced_.number == trial.number && announced_.phase == trial.phase &&
      announced_.start_tick == trial.start_tick) {
    return;  // the same again
  }
  if (stage_ == Stage::kRuns) trials_.back().to_ns = at_ns;
  announced_ = trial;
  const bool runs = trial.phase != TrialPhase::kIdle && trial.start_tick >= 0;
  stage_ = runs && trials_.size() < kMostTrials ? Stage::kAwaited : Stage::kNone;
}

void Timeline::tick(Tick tick, std::int64_t at_ns) {
  if (stage_ == Stage::kNone || tick < announced_.start_tick) return;
  if (stage_ == Stage::kAwaited) {
    trials_.push_back({announced_.number, announced_.phase, at_ns, at_ns});
  }
  const bool over = tick - announced_.start_tick >= announced_.duration_ticks;
  stage_ = over ? Stage::kNone : Stage::kRuns;
  trials_.back().to_ns = at_ns;
}

std::vector<Mark> Timeline::marks(MarkKind kind) const {
  std::vector<Mark> found;
  for (const auto& [place, mark] : marks_) {
    if (place.first == kind) found.push_back(mark);
  }
  return found;
}

}  // namespace stillhand::dashboard
