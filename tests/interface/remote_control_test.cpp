// SPDX-License-Identifier: Apache-2.0
// Commands from outside of a session, on the real bus.
#include "services/bus/remote_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "idl/recording.h"
#include "places.hpp"
#include "tests/support/bus_options.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using stillhand_msgs::RecorderCommand;
using stillhand_msgs::RecorderStatus;
using support::eventually;

struct Asker {
  explicit Asker(const char* name)
      : bus(support::bus_options(name)),
        commands(bus.publisher<RecorderCommand>(topics::kRecorderCommand)) {
    bus.subscribe<RecorderStatus>(topics::kRecorderStatus,
                                  [this](const RecorderStatus& status, const Arrival&) {
                                    const std::lock_guard lock(mutex);
                                    if (status.answered() != 0) answered.insert(status.answered());
                                  });
    bus.start();
  }
  ~Asker() { bus.stop_receiving(); }
  void ask(std::uint64_t request) {
    RecorderCommand command;
    command.request(request);
    commands.write(command);
  }
  bool has_answer(std::uint64_t request) {
    const std::lock_guard lock(mutex);
    return answered.contains(request);
  }
  std::mutex mutex;
  std::set<std::uint64_t> answered;
  Bus bus;
  Publisher<RecorderCommand> commands;
};

TEST(RemoteControlTest, EachRequestOfTwoAskersIsCarriedOutOnceAndAnswered) {
  RemoteControl<RecorderCommand, RecorderStatus> sut(
      support::bus_options("record"), topics::kRecorderCommand, topics::kRecorderStatus);
  Asker a("a");
  Asker b("b");
  const auto matched = [](Asker& asker) {
    return asker.bus.matched_peers(topics::kRecorderCommand).contains("record") &&
           asker.bus.matched_peers(topics::kRecorderStatus).contains("record");
  };
  ASSERT_TRUE(eventually([&] { return matched(a) && matched(b); }));
  std::vector<std::uint64_t> done;
  const auto carried_out = [&](std::uint64_t request) {
    return eventually([&] {
      while (const auto command = sut.next()) {
        done.push_back(command->request());
        sut.answer(*command, "");
      }
      return std::ranges::find(done, request) != done.end();
    });
  };
  a.ask(1);
  ASSERT_TRUE(carried_out(1));
  b.ask(2);
  ASSERT_TRUE(carried_out(2));
  a.ask(1);  // again, for others
  a.ask(3);
  ASSERT_TRUE(carried_out(3));
  EXPECT_THAT(done, testing::ElementsAre(1, 2, 3));
  // Best effort, so until they are there.
  EXPECT_TRUE(eventually([&] {
    sut.publish({});
    return a.has_answer(1) && b.has_answer(2) && a.has_answer(3);
  }));
}

}  // namespace
}  // namespace stillhand::runtime
