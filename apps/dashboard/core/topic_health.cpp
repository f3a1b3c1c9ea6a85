// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/topic_health.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "services/core/contract/time_difference.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::int64_t kMostLost = 1'000'000'000;  // [ticks] in a product with a period

void note(Lateness& lateness, std::int64_t by_ns, std::int64_t at_ns) {
  if (by_ns <= 0) return;
  if (lateness.count++ == 0) lateness.first_at_ns = at_ns;
  lateness.worst_ns = std::max(lateness.worst_ns, by_ns);
  lateness.last_at_ns = at_ns;
}

}  // namespace

TopicHealth::TopicHealth(TopicPlan plan) : plan_(std::move(plan)) {}

bool TopicHealth::superseded(const Sample& sample) const noexcept {
  return sample.tick >= 0 && !writers_.empty() && sample.writer < writers_.front().number &&
         difference_ns(sample.arrived_ns, writers_.front().last_at_ns) < kSecond_ns;
}

TopicHealth::Writer& TopicHealth::writer_of(const Sample& sample) {
  const auto known = std::ranges::find(writers_, sample.writer, &Writer::number);
  if (known != writers_.end()) return *known;
  if (sample.tick >= 0 && !writers_.empty()) *this = TopicHealth(plan_);
  Writer fresh;
  fresh.number = sample.writer;
  if (writers_.size() < kMostWriters) return writers_.emplace_back(fresh);
  // Bounded for any number of writers: the one that was silent longest is forgotten.
  Writer& oldest = *std::ranges::min_element(writers_, {}, &Writer::last_at_ns);
  return oldest = fresh;
}

void TopicHealth::turn_to(std::int64_t second) {
  if (second <= now_.number) return;  // a late report of an arrival counts for the newest second
  if (now_.number == second - 1) {
    std::swap(before_, now_);
  } else {
    before_ = {};
    before_.number = second - 1;
  }
  now_.number = second;
  now_.samples = 0;
  now_.jitter.clear();
  now_.latency.clear();
}

// Eq. DB-3.  The time of a lost sample is a gap, not lateness.
std::int64_t TopicHealth::late_by(std::int64_t interval_ns, std::int64_t lost) const noexcept {
  if (plan_.deadline_ns == 0) return 0;
  const std::int64_t explained_ns = std::min(lost, kMostLost) * plan_.period_ns;
  return std::max<std::int64_t>(interval_ns - explained_ns - plan_.deadline_ns, 0);
}

Verdict TopicHealth::step(const Sample& sample, std::int64_t ahead_ns) {
  if (superseded(sample)) return {0, 0, 0, false};
  Writer& writer = writer_of(sample);
  turn_to(sample.arrived_ns / kSecond_ns);
  const bool first = writer.count.received() == 0;
  const std::int64_t lost_before = writer.count.lost();
  const std::int64_t not_sent_before = writer.count.not_sent();
  writer.count.step(sample.sequence, sample.tick);

  Verdict verdict;
  verdict.lost = writer.count.lost() - lost_before;
  if (verdict.lost > 0 && lost_ == 0) lost_since_ns_ = sample.arrived_ns;
  lost_ += static_cast<std::uint64_t>(verdict.lost);
  not_sent_ += static_cast<std::uint64_t>(writer.count.not_sent() - not_sent_before);

  const std::int64_t stamp_ns = sample.tick >= 0 ? sample.stamp_ns : sample.source_ns;
  if (!first) {
    verdict.sent_late_ns = late_by(difference_ns(stamp_ns, writer.last_stamp_ns), verdict.lost);
    const std::int64_t interval_ns = difference_ns(sample.arrived_ns, writer.last_at_ns);
    verdict.arrived_late_ns = late_by(interval_ns, verdict.lost);
    note(sent_, verdict.sent_late_ns, sample.arrived_ns);
    note(arrived_, verdict.arrived_late_ns, sample.arrived_ns);
    if (plan_.period_ns > 0) {
      const std::int64_t due_ns = (1 + std::min(verdict.lost, kMostLost)) * plan_.period_ns;
      const std::int64_t jitter_ns = std::abs(interval_ns - due_ns);
      jitter_.add(jitter_ns);
      now_.jitter.add(jitter_ns);
    }
  }
  const std::int64_t latency_ns = difference_ns(sample.arrived_ns, sample.source_ns) + ahead_ns;
  latency_.add(latency_ns);
  now_.latency.add(latency_ns);
  writer.last_stamp_ns = stamp_ns;
  writer.last_at_ns = sample.arrived_ns;
  ++now_.samples;
  if (samples_++ == 0) {
    first_at_ns_ = sample.arrived_ns;
    first_tick_ = sample.tick;
  }
  last_at_ns_ = std::max(last_at_ns_, sample.arrived_ns);
  last_tick_ = sample.tick;
  return verdict;
}

// The one before the newest sample's, unless that is itself over.
const TopicHealth::Second* TopicHealth::whole_second(std::int64_t now_ns) const noexcept {
  const std::int64_t second = now_ns / kSecond_ns;
  if (now_.number >= second) return &before_;
  return now_.number == second - 1 ? &now_ : nullptr;
}

std::int64_t TopicHealth::recent_latency_p99_ns(std::int64_t now_ns) const noexcept {
  const Second* whole = whole_second(now_ns);
  return whole == nullptr ? 0 : whole->latency.quantile_ns(0.99);
}

TopicReport TopicHealth::report(std::int64_t now_ns) const {
  TopicReport report;
  report.samples = samples_;
  report.lost = lost_;
  report.not_sent = not_sent_;
  report.negative_latencies = latency_.negative();
  report.lost_since_ns = lost_since_ns_;
  report.first_tick = first_tick_;
  report.last_tick = last_tick_;
  report.sent = sent_;
  report.arrived = arrived_;
  report.jitter = jitter_.spread();
  report.latency = latency_.spread();
  report.first_at_ns = first_at_ns_;
  report.last_at_ns = last_at_ns_;
  if (const Second* whole = whole_second(now_ns)) {
    report.rate_hz = static_cast<double>(whole->samples);
    report.recent_jitter = whole->jitter.spread();
    report.recent_latency = whole->latency.spread();
  }
  return report;
}

std::vector<std::uint64_t> TopicHealth::jitter_up_to(
    const std::vector<std::int64_t>& edges_ns) const {
  std::vector<std::uint64_t> counts;
  for (const std::int64_t edge_ns : edges_ns) counts.push_back(jitter_.count_up_to(edge_ns));
  return counts;
}

}  // namespace stillhand::dashboard
