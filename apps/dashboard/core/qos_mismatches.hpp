// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stillhand::dashboard {

/// An endpoint that another endpoint cannot match, as reported by its process.
struct QosMismatch {
  std::string service, topic, policy;
  std::int64_t since_ns = 0, last_ns = 0;
};

/// Endpoints that cannot match, with the policy and the time.  DDS reports a mismatch once for each
/// pair and does not report its end, so it holds until another process of that name starts.
/// Bounded for any number of processes.  Pure; one thread.
class QosMismatches {
 public:
  /// @param text  the policy, and behind a comma how often
  void note(std::string service, std::string topic, const std::string& text, std::int64_t at_ns) {
    std::string policy = text.substr(0, text.find(','));
    const auto known = std::ranges::find_if(all_, [&](const QosMismatch& each) {
      return each.service == service && each.topic == topic && each.policy == policy;
    });
    if (known != all_.end()) {
      known->last_ns = std::max(known->last_ns, at_ns);
      return;
    }
    if (all_.size() == kMost) all_.erase(all_.begin());
    all_.push_back({std::move(service), std::move(topic), std::move(policy), at_ns, at_ns});
  }
  /// A process of that name started: earlier mismatches are over.
  void begun(const std::string& service, std::int64_t at_ns) {
    // Its first report of a mismatch may arrive shortly before its first status.
    std::erase_if(all_, [&](const QosMismatch& each) {
      return each.service == service && each.last_ns < at_ns - kBefore_ns;
    });
  }

  /// In the order of their first reports.
  [[nodiscard]] const std::vector<QosMismatch>& all() const noexcept { return all_; }

 private:
  static constexpr std::size_t kMost = 64;
  static constexpr std::int64_t kBefore_ns = 1'000'000'000;

  std::vector<QosMismatch> all_;
};

}  // namespace stillhand::dashboard
