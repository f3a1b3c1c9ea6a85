// SPDX-License-Identifier: Apache-2.0
// `stillhand stop` and a rig that answers it, on the real bus.
#include "apps/stop/stop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/process/domain.hpp"
#include "tests/support/bus_options.hpp"

namespace stillhand::stop {
namespace {

/// Reports zero force for each request, or only says that it had reported it before.
struct Rig {
  explicit Rig(bool answers = true)
      : bus(support::bus_options("rig")),
        events(bus.publisher<stillhand_msgs::Event>(topics::kEvent)) {
    bus.subscribe<stillhand_msgs::SessionCommand>(
        topics::kSessionCommand,
        [this, answers](const stillhand_msgs::SessionCommand&, const auto&) {
          if (!answers) return;
          // As a reporter sorts and counts what happened within a tenth of a second.
          report(stillhand_msgs::EVENT_INTERLOCK_OPENED, "emergency stop, 2 times",
                 stillhand_msgs::CODE_EMERGENCY_STOP);
          report(stillhand_msgs::EVENT_INTERLOCK_OPENED, "rig", stillhand_msgs::CODE_NONE);
          report(stillhand_msgs::EVENT_FORCE_ZERO, "", stillhand_msgs::CODE_NONE);
        });
    bus.start();
  }
  ~Rig() { bus.stop_receiving(); }
  void report(stillhand_msgs::EventKind kind, const char* text, stillhand_msgs::EventCode code) {
    stillhand_msgs::Event event;
    event.source("rig");
    event.kind(kind);
    event.text(text);
    event.code(code);
    events.write(event);
  }
  runtime::Bus bus;
  runtime::Publisher<stillhand_msgs::Event> events;
};

StopOptions options() {
  StopOptions options;
  options.profiles = support::bus_options("rig").profiles;
  return options;
}

// Anybody on the machine may bind a socket that is named like a lab's.
TEST(StopTest, ASessionThatCannotBeAskedKeepsNoOtherFromBeingAsked) {
  const Rig rig;
  const std::vector<RunningSession> sessions{{runtime::kMaxDomain + 1, 1},
                                             {support::own_domain(), 1}};
  const runtime::Stop never;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int status = stop_sessions(sessions, options(), never);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("rig 1: force zero"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::HasSubstr("domain 233 rig 1: "));
  EXPECT_EQ(status, 1);
}

// Without keys anybody may call themselves the rig, and be found before it.
TEST(StopTest, AStrangerThatCallsItselfTheRigDoesNotAnswerForIt) {
  const Rig stranger;
  const Rig rig(false);
  StopOptions asked = options();
  asked.wait_s = 3.0;
  const runtime::Stop never;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int status =
      stop_sessions(std::vector<RunningSession>{{support::own_domain(), 1}}, asked, never);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::HasSubstr("2 participants call themselves the rig"));
  testing::internal::GetCapturedStderr();
  EXPECT_EQ(status, 1);
}

TEST(StopTest, WhatTheUserCanMendIsReportedAsSuch) {
  const std::vector<RunningSession> sessions{{support::own_domain(), 1}};
  const runtime::Stop never;
  StopOptions wrong = options();
  wrong.profiles = "/nowhere";
  EXPECT_THROW(stop_sessions(sessions, wrong, never), ConfigError);
}

}  // namespace
}  // namespace stillhand::stop
