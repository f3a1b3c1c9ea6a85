// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/clock_steps.hpp"

#include <algorithm>

#include "services/core/contract/time_difference.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"

namespace stillhand::recording {
namespace {

// A recorder next to busy processes takes a while for what has waited, even 30 ms of it.
constexpr std::int64_t kWait_ns = 200'000'000;
constexpr std::size_t kMost = 16;  // of more, the log times are no clock's that a person sets

// Modulo 2^64: times in a file may be anything.
std::int64_t less(std::int64_t a_ns, std::int64_t b_ns) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a_ns) -
                                   static_cast<std::uint64_t>(b_ns));
}

}  // namespace

void ClockStepFinder::take(std::uint64_t chunk, std::uint64_t message, ChannelId channel,
                           bool stream, std::uint64_t log_time_ns,
                           std::span<const std::byte> bytes) {
  if (stream != streams_ || steps_.size() > kMost) return;
  const SampleHead head = stream ? sample_head(bytes) : SampleHead{};
  if (stream && head.tick < 0) return;
  if (!stream) channel = 0;  // all of them together
  const auto log_ns = static_cast<std::int64_t>(log_time_ns - shift_ns_);
  const std::int64_t ahead_ns = stream ? less(log_ns, head.stamp_ns) : 0;
  const auto [known, first] = newest_.try_emplace(channel, Stream{ahead_ns, log_ns});
  Stream& newest = known->second;
  if (first) return;
  const std::int64_t back_ns = less(log_ns, newest.log_ns);
  const std::int64_t jump_ns = stream ? less(ahead_ns, newest.ahead_ns) : back_ns;
  const ClockStep step{chunk, message, static_cast<std::uint64_t>(less(log_ns, jump_ns)), jump_ns};
  if (back_ns < 0 && jump_ns < -kLeast_ns) {
    return accept(step);
  }
  if (forward_ && forward_->channel == channel) {
    if (head.stamp_ns < forward_->decided_ns) return;
    if (still_ahead(*forward_, jump_ns)) accept(forward_->step);
    forward_.reset();
    return;
  }
  if (stream && jump_ns > kLeast_ns) {
    if (!forward_) forward_ = {step, channel, less(head.stamp_ns, -kWait_ns)};
    return;
  }
  newest = {ahead_ns, std::max(log_ns, newest.log_ns)};
}

bool ClockStepFinder::still_ahead(const Forward& forward, std::int64_t jump_ns) const {
  return jump_ns > forward.step.by_ns - std::min(forward.step.by_ns, kWait_ns) / 2;
}

void ClockStepFinder::accept(const ClockStep& step) {
  steps_.push_back(step);
  shift_ns_ += static_cast<std::uint64_t>(step.by_ns);
}

std::vector<ClockStep> ClockStepFinder::found(std::optional<std::int64_t> total_ns) const {
  std::vector<ClockStep> steps = steps_;
  if (forward_ && total_ns) {
    const auto before_ns = static_cast<std::int64_t>(shift_ns_);
    const std::int64_t left_ns = difference_ns(*total_ns, before_ns);
    if (std::abs(difference_ns(left_ns, forward_->step.by_ns)) < kLeast_ns) {
      steps.push_back(forward_->step);
    }
  }
  return steps.size() > kMost ? std::vector<ClockStep>{} : steps;
}

}  // namespace stillhand::recording
