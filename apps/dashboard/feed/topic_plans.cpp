// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/topic_plans.hpp"

#include <cstdint>
#include <string>
#include <utility>

#include "services/core/contract/units.hpp"

namespace stillhand::dashboard {

std::vector<TopicPlan> topic_plans(const Config& config) {
  std::vector<TopicPlan> all;
  for (const topics::Topic* row : kFeedTopics) {
    TopicPlan plan{std::string(row->name), 0, 0};
    // The clocks' topics come in bursts, one message for each process.
    if (row->rate_hz > 0.0 && row->pattern != topics::Pattern::kExchange) {
      plan.period_ns = static_cast<std::int64_t>(kNsPerS / row->rate_hz);
    }
    if (row->pattern == topics::Pattern::kStream1khz) {
      plan.deadline_ns = static_cast<std::int64_t>(config.deadline_ms * kNsPerMs);
    }
    all.push_back(std::move(plan));
  }
  return all;
}

}  // namespace stillhand::dashboard
