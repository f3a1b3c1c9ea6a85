// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "tests/support/idl_fields.hpp"

namespace stillhand::equivalence {

/// What a step used is not in the recording; the text says what.
class NotRecorded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What came of a core's replay.
struct Replay {
  std::string core;
  Tick first_tick = -1;         ///< the core started from rest here
  std::int64_t recorded = 0;    ///< outputs in the recording
  std::int64_t compared = 0;    ///< outputs, all their bytes but rig number and stamp
  std::int64_t different = 0;   ///< of these
  std::int64_t unseen = 0;      ///< ticks that did not reach the live core: it flagged a gap
  std::int64_t unrecorded = 0;  ///< outputs that did not reach the recorder
  Tick first_difference_tick = -1;
  std::string first_difference;
  std::string ended;  ///< why the replay ended before the recording, or empty
};

/// Messages of one topic by their tick.
template <typename Message>
class ByTick {
 public:
  ByTick(std::string topic, const std::vector<Message>& messages) : topic_(std::move(topic)) {
    for (const Message& message : messages) by_tick_.emplace(message.tick(), &message);
  }
  /// @throws NotRecorded
  const Message& at(Tick tick) const {
    const auto found = by_tick_.find(tick);
    if (found == by_tick_.end()) {
      throw NotRecorded(topic_ + " of tick " + std::to_string(tick) + " is not in the recording");
    }
    return *found->second;
  }
  [[nodiscard]] bool has(Tick tick) const { return by_tick_.count(tick) != 0; }
  /// nullptr for tick -1, which stands for none.
  const Message* used(Tick tick) const { return tick < 0 ? nullptr : &at(tick); }

 private:
  std::string topic_;
  std::unordered_map<Tick, const Message*> by_tick_;
};

/// Notes one pair; rig number and stamp are the publisher's, not the core's.
template <typename Output>
void compare(Output replayed, const Output& recorded, Tick tick, Replay& replay) {
  replayed.rig(recorded.rig());
  replayed.stamp_ns(recorded.stamp_ns());
  ++replay.compared;
  if (to_cdr(replayed) == to_cdr(recorded)) return;
  if (replay.different++ > 0) return;
  replay.first_difference_tick = tick;
  replay.first_difference =
      "tick " + std::to_string(tick) + ": " + tests::differences(replayed, recorded);
}

/// Replays the recorded outputs of a core in their order.
///
/// A gap in the outputs has one of two causes.  With kInputGap on the next output the live core got
/// nothing for these ticks, and neither does the replayed one.  Without it only the recorder lost
/// them: the core steps, and nothing is compared.
///
/// @param step   Output(tick, like): steps the core at a tick with the settings that the recorded
///               output `like` holds (permitted, trial, ...); throws NotRecorded
/// @param agree  bool(before, after): the settings of two outputs are the same, and then also of
///               those lost between them
template <typename Output, typename Step, typename Agree>
Replay replay(const std::string& core, const std::vector<Output>& outputs, const Step& step,
              const Agree& agree) {
  Replay result;
  result.core = core;
  result.recorded = std::ssize(outputs);
  const Output* before = nullptr;
  try {
    for (const Output& recorded : outputs) {
      const Tick tick = recorded.tick();
      if (before == nullptr) result.first_tick = tick;
      const Tick expected = before == nullptr ? tick : before->tick() + 1;
      if (tick < expected) throw NotRecorded("recorded out of order at " + std::to_string(tick));
      if ((recorded.flags() & kInputGap) != 0) {
        result.unseen += tick - expected;
      } else {
        for (Tick lost = expected; lost < tick; ++lost, ++result.unrecorded) {
          if (!agree(*before, recorded)) {
            throw NotRecorded("output of tick " + std::to_string(lost) +
                              " is not in the recording, and the settings changed there");
          }
          step(lost, recorded);
        }
      }
      compare(step(tick, recorded), recorded, tick, result);
      before = &recorded;
    }
  } catch (const NotRecorded& reason) {
    result.ended = reason.what();
  }
  return result;
}

}  // namespace stillhand::equivalence
