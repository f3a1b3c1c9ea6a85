// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/core/contract/trial.hpp"

namespace stillhand::session {

/// Samples of a stream within a trial's measured ticks, one a tick.  A lost one repeats the one
/// before.
/// @param value    of a message
/// @param missing  counts the lost ones
template <typename Message, typename Value>
std::vector<double> measured(const std::vector<Message>& stream, const Trial& trial, Value value,
                             std::int64_t& missing) {
  std::vector<double> samples;
  samples.reserve(static_cast<std::size_t>(trial.duration_ticks));
  double last = 0.0;
  for (const Message& message : stream) {
    if (!trial.measures(message.tick())) continue;
    const auto place = static_cast<std::size_t>(message.tick() - trial.start_tick);
    while (samples.size() < place) {
      samples.push_back(last);
      ++missing;
    }
    last = value(message);
    if (samples.size() == place) samples.push_back(last);
  }
  while (samples.size() < static_cast<std::size_t>(trial.duration_ticks)) {
    samples.push_back(last);
    ++missing;
  }
  return samples;
}

}  // namespace stillhand::session
