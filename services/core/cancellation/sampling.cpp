// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/sampling.hpp"

#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation {

SamplingConfig sampling_named(std::string_view name) {
  if (name == "now") return {};
  if (name == "paper") return {5, 10.0, 20, 1};
  throw ConfigError("canceller", std::string(name), "now or paper");
}

void HeldForce::push(const Force& force, std::int64_t latency_samples) noexcept {
  const auto latency = static_cast<std::size_t>(latency_samples);
  if (latency == 0) {
    acting_ = force;
    return;
  }
  next_ %= latency;
  acting_ = waiting_[next_];
  waiting_[next_] = force;
  next_ = (next_ + 1) % latency;
}

}  // namespace stillhand::cancellation
