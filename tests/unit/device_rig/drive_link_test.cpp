// SPDX-License-Identifier: Apache-2.0
// The drive's thread against the emulator behind a pseudo-terminal.
#include "services/devices/device_rig/drive_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/system/process/clock.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/wait.hpp"
#include "tests/unit/device_rig/emulated_drive.hpp"

namespace stillhand::device_rig::drive_link_test {

using support::eventually;
using testing::HasSubstr;

constexpr SettingLimits kLimits{.max_current_a = 10.0, .travel_rev = 0.083};

/// A link to an emulated drive.
class DriveLinkTest : public testing::Test {
 protected:
  explicit DriveLinkTest(bool uart = false) : emulated_(uart) {
    config_.port = emulated_.port();
    config_.watchdog_s = 0.1;
    config_.checksum = uart;
  }
  std::string refusal() {
    return support::refusal([&] { const DriveLink sut(config_, kLimits); });
  }
  /// Orders until the condition holds.
  template <typename Condition>
  bool orders_until(DriveLink& sut, Order order, double torque_n_m, Condition condition) {
    return eventually([&] {
      // A busy machine may trip the watchdog, which latches.
      const bool tripped = sut.newest().reply.mode == DriveMode::kTimedOut;
      sut.demand(tripped ? Order::kStop : order, torque_n_m);
      ++demands_;
      return condition(sut.newest());
    });
  }

  EmulatedDrive emulated_;
  DriveConfig config_;
  std::uint64_t demands_ = 0;
};

class UartLinkTest : public DriveLinkTest {
 protected:
  UartLinkTest() : DriveLinkTest(true) {}
};

TEST_F(DriveLinkTest, ReadsTheSettingsBackAndFollowsOrders) {
  DriveLink sut(config_, kLimits);
  EXPECT_TRUE(sut.newest().checked);
  EXPECT_TRUE(orders_until(sut, Order::kTorque, 0.5, [](const DriveSample& sample) {
    return sample.reply.mode == DriveMode::kTorque && sample.reply.torque_n_m > 0.49;
  }));
  EXPECT_EQ(emulated_.record().without_watchdog, 0u);
}

TEST_F(UartLinkTest, SpeaksWithChecksums) {
  DriveLink sut(config_, kLimits);
  EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                           [](const DriveSample& sample) { return sample.sequence > 5; }));
  EXPECT_EQ(sut.newest().damaged, 0u);
  EXPECT_EQ(sut.serial(), "00003230-00005030-001d003a");
}

TEST_F(DriveLinkTest, ADriveThatDampsAfterATimeoutIsRefusedWithTheCommandThatMendsIt) {
  emulated_.with([](auto& drive, auto&) { drive.set("servo.timeout_mode", "12"); });
  EXPECT_THAT(refusal(), HasSubstr("servo.timeout_mode: got 12, want 0: the driver is off after a "
                                   "timeout; this mends it: conf set servo.timeout_mode 0"));
}

TEST_F(DriveLinkTest, ADriveWithTooMuchCurrentIsRefused) {
  emulated_.with([](auto& drive, auto&) { drive.set("servo.max_current_A", "40.0"); });
  EXPECT_THAT(refusal(), HasSubstr("servo.max_current_A: got 40.0, want at most 10 A"));
}

TEST_F(DriveLinkTest, ADriveThatDoesNotAnswerOrAnswersLateIsRefused) {
  emulated_.with([](auto&, auto& serial) { serial.mischief.late_ms = 30.0; });
  EXPECT_THAT(refusal(), HasSubstr("want at most 10 ms"));
  emulated_.with([](auto&, auto& serial) { serial.mischief.silent = true; });
  EXPECT_THAT(refusal(), HasSubstr("got no answer"));
}

TEST_F(DriveLinkTest, TwoProcessesDoNotShareAPort) {
  const DriveLink sut(config_, kLimits);
  EXPECT_THAT(refusal(), testing::AnyOf(HasSubstr("another process"), HasSubstr("busy")));
}

TEST_F(DriveLinkTest, ItSendsNothingByItselfSoTheWatchdogTrips) {
  DriveLink sut(config_, kLimits);
  ASSERT_TRUE(orders_until(sut, Order::kTorque, 0.5, [](const DriveSample& sample) {
    return sample.reply.torque_n_m > 0.49;
  }));
  EXPECT_TRUE(eventually(
      [&] { return emulated_.record().timeouts >= 1 && emulated_.torque_n_m() == 0.0; }));
  EXPECT_EQ(emulated_.torque_n_m(), 0.0);
  // A busy machine trips the watchdog by itself: the number of commands is the proof.
  EXPECT_LE(emulated_.record().commands, demands_);
}

TEST_F(DriveLinkTest, ItsEndSwitchesTheDriverOff) {
  {
    DriveLink sut(config_, kLimits);
    ASSERT_TRUE(orders_until(sut, Order::kTorque, 0.5, [](const DriveSample& sample) {
      return sample.reply.mode == DriveMode::kTorque;
    }));
  }
  EXPECT_TRUE(eventually(
      [&] { return emulated_.with([](auto& drive, auto&) { return drive.mode() == 0; }); }));
}

TEST_F(DriveLinkTest, ADriveThatStartsAnewIsCheckedAgain) {
  DriveLink sut(config_, kLimits);
  ASSERT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                           [](const DriveSample& sample) { return sample.sequence > 300; }));
  emulated_.with([](auto& drive, auto&) { drive.reboot(runtime::monotonic_ns()); });
  EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                           [](const DriveSample& sample) { return !sample.checked; }));
  EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                           [](const DriveSample& sample) { return sample.checked; }));
}

TEST_F(DriveLinkTest, AfterTheCableWasOutTheDriveIsCheckedAgain) {
  DriveLink sut(config_, kLimits);
  emulated_.with([](auto&, auto& serial) { serial.pull_out(); });
  EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                           [](const DriveSample& sample) { return !sample.checked; }));
  // The adapter lost its power, too.
  emulated_.with([](auto& drive, auto& serial) {
    drive.turn_bus_off();
    serial.put_in();
  });
  EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                           [](const DriveSample& sample) { return sample.checked; }));
}

// Its angle has another zero, and nobody calibrated what is wired to it.
TEST_F(DriveLinkTest, AnotherDriveInItsPlaceIsNotChecked) {
  DriveLink sut(config_, kLimits);
  emulated_.with([](auto&, auto& serial) { serial.pull_out(); });
  EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                           [](const DriveSample& sample) { return !sample.checked; }));
  emulated_.with([](auto& drive, auto& serial) {
    drive.be(77);
    serial.put_in();
  });
  // The same drive is checked again after 2.1 s (the test before).
  EXPECT_FALSE(eventually([&] { return sut.newest().checked; }, std::chrono::seconds(4)));
}

TEST_F(DriveLinkTest, DamagedTruncatedAndSenselessAnswersAreNoSamples) {
  DriveLink sut(config_, kLimits);
  for (bool emulators::Mischief::* kind :
       {&emulators::Mischief::garbage, &emulators::Mischief::truncated}) {
    emulated_.with([&](auto&, auto& serial) { serial.mischief.*kind = true; });
    // What was under way before comes first.
    std::uint64_t last = 0;
    EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0, [&](const DriveSample& sample) {
      return sample.sequence == std::exchange(last, sample.sequence);
    }));
    emulated_.with([&](auto&, auto& serial) { serial.mischief.*kind = false; });
    EXPECT_TRUE(orders_until(sut, Order::kQuery, 0.0,
                             [&](const DriveSample& sample) { return sample.sequence > last; }));
  }
}

}  // namespace stillhand::device_rig::drive_link_test
