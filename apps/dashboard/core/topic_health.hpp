// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/dashboard/core/log_histogram.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/recording/loss_count.hpp"

namespace stillhand::dashboard {

/// The expected timing of a topic.
struct TopicPlan {
  std::string name;
  std::int64_t period_ns = 0;    ///< [ns] between two samples of one writer, 0: when it happens
  std::int64_t deadline_ns = 0;  ///< [ns] longest time between two, 0: none
};

/// One sample of one writer, as any listener has it.
struct Sample {
  std::size_t writer = 0;       ///< the writer's number, in the order of finding
  std::int64_t sequence = 0;    ///< DDS's, counted by the writer
  Tick tick = -1;               ///< -1: the type has none
  std::int64_t stamp_ns = 0;    ///< [ns] writer's monotonic clock; with a tick only
  std::int64_t source_ns = 0;   ///< [ns] writer's system clock
  std::int64_t arrived_ns = 0;  ///< [ns] listener's system clock
};

/// The result of one sample.
struct Verdict {
  std::int64_t lost = 0;          ///< [ticks] or messages missing just before it
  std::int64_t sent_late_ns = 0;  ///< [ns] interval of the stamps beyond what ticks explain; >= 0
  std::int64_t arrived_late_ns = 0;  ///< [ns] the same of the arrivals
  bool counted = true;               ///< false: of a writer that another has taken the place of
};

/// Intervals beyond the deadline.
struct Lateness {
  std::uint64_t count = 0;
  std::int64_t worst_ns = 0;     ///< [ns] by how much beyond
  std::int64_t first_at_ns = 0;  ///< [ns] arrival of the first such sample, 0 none
  std::int64_t last_at_ns = 0;   ///< [ns] of the newest
};

/// Everything about a topic at one instant.
struct TopicReport {
  std::uint64_t samples = 0, lost = 0, not_sent = 0, negative_latencies = 0;
  std::int64_t lost_since_ns = 0;  ///< [ns] arrival of the first sample behind a gap, 0 none
  Tick first_tick = -1, last_tick = -1;
  double rate_hz = 0.0;  ///< [Hz] in the last whole second
  Lateness sent, arrived;
  Spread jitter, latency;                ///< of all samples
  Spread recent_jitter, recent_latency;  ///< of the last whole second
  std::int64_t first_at_ns = 0, last_at_ns = 0;
};

/// Health of one topic, Eq. DB-1 to DB-4: rate, jitter of the arrivals, one-way latency, gaps and
/// missed deadlines.  Figures from ticks, sequence numbers and stamps are the same for every
/// listener that lost no sample; figures from arrivals belong to this listener.
///
/// A topic with ticks has one writer.  A writer that is found later belongs to another session, and
/// counting begins again.  An earlier writer is then not counted, unless the later one is silent
/// for a second, so two writers at the same time cannot restart the count repeatedly. Pure: time
/// enters with the samples.  Allocates at a writer's first sample alone; one thread.
class TopicHealth {
 public:
  explicit TopicHealth(TopicPlan plan);

  /// @param ahead_ns  [ns] by how much the writer's system clock is ahead of the listener's; within
  /// what difference_ns() gives
  Verdict step(const Sample& sample, std::int64_t ahead_ns = 0);

  [[nodiscard]] TopicReport report(std::int64_t now_ns) const;
  /// [ns] of the last whole second; 0 without a sample in it.
  [[nodiscard]] std::int64_t recent_latency_p99_ns(std::int64_t now_ns) const noexcept;
  [[nodiscard]] const TopicPlan& plan() const noexcept { return plan_; }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
  /// [ns] arrival of the newest sample, 0 before the first.
  [[nodiscard]] std::int64_t last_at_ns() const noexcept { return last_at_ns_; }
  [[nodiscard]] std::int64_t first_at_ns() const noexcept { return first_at_ns_; }
  /// Jitters in all, counted up to each edge.
  [[nodiscard]] std::vector<std::uint64_t> jitter_up_to(
      const std::vector<std::int64_t>& edges_ns) const;

 private:
  struct Writer {
    std::size_t number = 0;
    recording::LossCount count;
    std::int64_t last_stamp_ns = 0, last_at_ns = 0;
  };
  /// One second of the listener's clock.
  struct Second {
    std::int64_t number = -1;
    std::uint64_t samples = 0;
    LogHistogram jitter, latency;
  };

  Writer& writer_of(const Sample& sample);
  [[nodiscard]] bool superseded(const Sample& sample) const noexcept;
  void turn_to(std::int64_t second);
  [[nodiscard]] const Second* whole_second(std::int64_t now_ns) const noexcept;
  [[nodiscard]] std::int64_t late_by(std::int64_t interval_ns, std::int64_t lost) const noexcept;

  static constexpr std::size_t kMostWriters = 64;

  TopicPlan plan_;
  std::vector<Writer> writers_;
  std::uint64_t samples_ = 0, lost_ = 0, not_sent_ = 0;
  std::int64_t lost_since_ns_ = 0, first_at_ns_ = 0, last_at_ns_ = 0;
  Tick first_tick_ = -1, last_tick_ = -1;
  Lateness sent_, arrived_;
  LogHistogram jitter_, latency_;
  Second now_, before_;
};

}  // namespace stillhand::dashboard
