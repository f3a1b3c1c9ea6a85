// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/core/contract/trial.hpp"

namespace stillhand::session {

/// Samples of a stream within a trial's measured ticks, one a tick.  A lost one repeats the one
/// before; one that comes late, or twice, does not count.
/// @param value    of a message
/// @param missing  [ticks] the lost ones, if it is wanted
template <typename Message, typename Value>
std::vector<double> measured(const std::vector<Message>& stream, const Trial& trial, Value value,
                             std::int64_t* missing = nullptr) {
  std::vector<double> samples;
  std::int64_t lost = 0;
  samples.reserve(static_cast<std::size_t>(trial.duration_ticks));
  double last = 0.0;
  for (const Message& message : stream) {
    if (!trial.measures(message.tick())) continue;
    const auto place = static_cast<std::size_t>(message.tick() - trial.start_tick);
    if (place < samples.size()) continue;
    for (; samples.size() < place; ++lost) samples.push_back(last);
    last = value(message);
    samples.push_back(last);
  }
  for (; samples.size() < static_cast<std::size_t>(trial.duration_ticks); ++lost) {
    samples.push_back(last);
  }
  if (missing != nullptr) *missing = lost;
  return samples;
}

}  // namespace stillhand::session
