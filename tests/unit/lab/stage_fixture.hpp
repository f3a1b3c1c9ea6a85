// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/trouble.hpp"

namespace stillhand::lab {

inline constexpr std::int64_t kMs = 1'000'000;
inline constexpr std::int64_t kSecond = 1000 * kMs;

/// A session of four processes, and a clock that the test sets.
class StageTest : public testing::Test {
 protected:
  StageTest() {
    for (const Member& member : roster_) {
      ProcessSeen seen;
      seen.matched = true;
      seen.tick = member.ticks ? 100 : -1;
      seen_.processes[member.name] = seen;
    }
  }

  /// Steps once, `after_ns` later.
  Actions step(Stage& stage, std::int64_t after_ns = 50 * kMs) {
    now_ns_ += after_ns;
    return stage.step(seen_, now_ns_);
  }
  /// Why a stage failed; empty: it is over without a failure.
  static std::string failure_of(const auto& sut) {
    return sut.over() ? sut.failure() : "it goes on";
  }
  /// Nothing has come by its limit, nor a nanosecond later.  @return the failure
  std::string failure_after(auto& sut, std::int64_t limit_ns) {
    step(sut);
    step(sut, limit_ns);
    EXPECT_FALSE(sut.over());
    step(sut, 1);
    return failure_of(sut);
  }
  /// A process ends, and the time is over after which that counts.
  void end_of_process(const Death& death, Stage& stage) {
    seen_.ended = death;
    step(stage);
    step(stage);
  }
  void event(EventKind kind, const std::string& source, const std::string& text = "") {
    EventSeen event;
    event.kind = kind;
    event.source = source;
    event.text = text;
    event.line = source + ": " + text;
    seen_.events.push_back(event);
  }
  std::string ask(Action action) {
    return seen_.requests.take({action, ++request_, "desk", ""}, seen_.trial_runs);
  }
  /// The sample clock, which every process follows.
  void rig_at(Tick tick) {
    for (auto& [name, process] : seen_.processes) process.tick = tick;
  }

  const Roster roster_{{"rig", true, true},
                       {"cancellation", true, true},
                       {"human_operator", true, false},
                       {"recorder", false, true}};
  Seen seen_;
  Trouble trouble_;
  std::int64_t now_ns_ = 1000 * kSecond;
  std::uint64_t request_ = 0;
};

}  // namespace stillhand::lab
