// SPDX-License-Identifier: Apache-2.0
// The parts of a rig of devices together, without a bus: a stick on a desk, whose drive is
// emulated, with a simulated platform.
#include "services/devices/device_rig/device_plant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "tests/support/wait.hpp"
#include "tests/unit/device_rig/emulated_drive.hpp"
#include "tests/unit/device_rig/emulated_platform.hpp"

namespace stillhand::device_rig::device_plant_test {

using support::eventually;

constexpr double kLever_m = 0.1;  // rig.yaml
constexpr Tick kFar = 1'000'000;

// A busy machine steps an emulated drive or platform late, too.
auto no_fault_but_of_the_machine() {
  return testing::AnyOf(testing::IsNull(), testing::HasSubstr("silent"));
}

class DevicePlantTest : public testing::Test {
 protected:
  DevicePlantTest() {
    auto& signals = devices_.signals;
    signals.force = signals.angle = signals.motor = "drive";
    devices_.drive.port = emulated_.port();
    // A busy machine steps the test late.
    devices_.drive.watchdog_s = 0.1;
    devices_.drive.max_age_ticks = 100;
  }
  /// One tick of the rig's shell.
  rig::RigOutput tick(rig::Plant& sut) {
    sut.begin(trial_, ++tick_);
    rig::RigInput input;
    input.motor_valid = true;
    input.motor_force_n = force_n_;
    input.motor_permitted = permitted_;
    auto output = sut.sample(input);
    sut.drive(input, output);
    return output;
  }
  template <typename Condition>
  bool ticks_until(rig::Plant& sut, Condition condition) {
    return eventually([&] { return condition(tick(sut)); });
  }
  void announce(std::int64_t number, TrialPhase phase) {
    trial_ = {.number = number, .phase = phase, .start_tick = 0, .duration_ticks = kFar};
  }
  bool stands_for(rig::Plant& sut, int ticks) {
    int still = 0;
    return ticks_until(sut,
                       [&](const auto&) {
                         if (emulated_.record().commands > 0) return true;
                         return ++still > ticks;
                       }) &&
           emulated_.record().commands == 0;
  }

  EmulatedDrive emulated_;
  DevicesConfig devices_;
  Trial trial_;
  Tick tick_ = 0;
  double force_n_ = 0.0;
  bool permitted_ = false;
};

// A new sensor whose put is forgotten: the simulated signal would go out under its name.
TEST(UnservedTest, ASignalOfADeviceThatNothingPutsIsNamed) {
  using Source = Parts::Source;
  Parts parts = parts_of({});
  EXPECT_EQ(unserved(parts, untouched()), nullptr);
  for (const Source source : {Source::kDrive, Source::kIio}) {
    parts.force = source;
    rig::RawSample raw = untouched();
    EXPECT_STREQ(unserved(parts, raw), "force");
    raw.load_cell_v = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(unserved(parts, raw), nullptr);
  }
  parts.acceleration = Source::kPlatform;
  rig::RawSample raw = untouched();
  raw.load_cell_v = raw.accel_y_v = 0.0;
  EXPECT_STREQ(unserved(parts, raw), "acceleration");
  raw.accel_x_v = raw.accel_z_v = 0.0;
  parts.angle = Source::kDrive;
  EXPECT_STREQ(unserved(parts, raw), "angle");
  raw.encoder_counts = 0;
  EXPECT_EQ(unserved(parts, raw), nullptr);
}

TEST_F(DevicePlantTest, NothingIsArmedWithoutPermissionOrWithThePegIn) {
  DevicePlant sut({}, devices_);
  ASSERT_TRUE(ticks_until(sut, [&](const auto&) { return sut.prepared(); }));
  force_n_ = 5.0;
  announce(1, TrialPhase::kTracking);
  EXPECT_TRUE(stands_for(sut, 100));
  announce(2, TrialPhase::kPegged);
  permitted_ = true;
  EXPECT_TRUE(stands_for(sut, 100));
  EXPECT_THAT(sut.unsound(), no_fault_but_of_the_machine());
}

TEST_F(DevicePlantTest, AForceIsATorqueWithItsSignAndComesWithoutAJump) {
  devices_.drive.torque_sign = -1;
  DevicePlant sut({}, devices_);
  announce(1, TrialPhase::kTracking);
  permitted_ = true;
  force_n_ = 8.0;
  ASSERT_TRUE(ticks_until(sut, [&](const auto& output) {
    // Both are of this tick or one before; a float's rounding.
    return std::abs(emulated_.torque_n_m() + kLever_m * output.truth.motor_force_n) < 1e-6 &&
           output.truth.motor_force_n > 7.99;
  }));
  EXPECT_EQ(emulated_.record().first_torque_n_m, 0.0);
  permitted_ = false;
  EXPECT_TRUE(ticks_until(sut, [&](const auto& output) {
    return output.truth.motor_force_n == 0.0 && emulated_.record().stops > 1 &&
           emulated_.torque_n_m() == 0.0;
  }));
}

TEST_F(DevicePlantTest, AMotorThatIsOffIsNeverDriven) {
  devices_.signals.motor = "off";
  DevicePlant sut({}, devices_);
  announce(1, TrialPhase::kTracking);
  permitted_ = true;
  force_n_ = 8.0;
  EXPECT_TRUE(stands_for(sut, 200));
}

TEST_F(DevicePlantTest, AngleAndForceAreTheDrivesAndTheRestIsSimulatedAndUnknown) {
  emulated_.with([](auto& drive, auto&) {
    drive.sense({.position_rev = 0.05, .velocity_rev_s = 0.0, .analog1 = 0.25, .analog2 = 0.5});
  });
  DevicePlant sut({}, devices_);
  rig::RigOutput output{};
  ASSERT_TRUE(ticks_until(sut, [&](const auto& now) {
    output = now;
    return output.raw.encoder_counts != 0 && sut.prepared();
  }));
  EXPECT_EQ(output.raw.encoder_counts, std::lround(0.05 * 4096));
  // A converter of 12 bit at 3.3 V.
  EXPECT_NEAR(output.raw.load_cell_v, 0.25 * 3.3, 3.3 / 4095);
  EXPECT_NEAR(output.raw.accel_z_v, 1.0, 0.05);  // the simulated accelerometer: 1 g
  EXPECT_TRUE(std::isnan(output.truth.feedthrough_force_n));
  EXPECT_STREQ(sut.parts(),
               "rig of devices: force drive, angle drive, motor drive; simulated: acceleration, "
               "platform");
}

TEST_F(DevicePlantTest, ASilentDriveIsUnsoundAndItsSamplesHaveNoValue) {
  DevicePlant sut({}, devices_);
  ASSERT_TRUE(ticks_until(sut, [&](const auto&) { return sut.prepared(); }));
  emulated_.with([](auto&, auto& serial) { serial.mischief.silent = true; });
  EXPECT_TRUE(ticks_until(sut, [&](const auto& output) {
    return sut.unsound() != nullptr && std::isnan(output.raw.load_cell_v);
  }));
  EXPECT_THAT(sut.unsound(), testing::StrEq("the drive is silent"));
  EXPECT_FALSE(sut.prepared());
}

TEST_F(DevicePlantTest, TheFlagsOfADeviceStayWhenASimulatedMotorIsDriven) {
  devices_.signals.motor = "simulated";
  DevicePlant sut({}, devices_);
  ASSERT_TRUE(ticks_until(sut, [&](const auto&) { return sut.prepared(); }));
  emulated_.with([](auto&, auto& serial) { serial.mischief.silent = true; });
  EXPECT_TRUE(ticks_until(
      sut, [&](const auto& output) { return (output.all_flags() & kInputStale) != 0; }));
}

TEST_F(DevicePlantTest, TheFlagsOfTheDrivesMotorAreThereInBothOrders) {
  DevicePlant sut({}, devices_);
  announce(1, TrialPhase::kTracking);
  ASSERT_TRUE(ticks_until(sut, [&](const auto&) { return sut.prepared(); }));
  EXPECT_NE(tick(sut).all_flags() & kInhibited, 0U) << "after its sample: no permission";
  sut.begin(trial_, ++tick_);
  EXPECT_NE(sut.step({.motor_valid = true}).all_flags() & kInhibited, 0U) << "before its sample";
}

// A seat that stands off the middle, and a motion that asks for the middle at each tick.
class SeatTest : public testing::Test {
 protected:
  SeatTest() {
    devices_.signals.platform = "plain_udp";
    devices_.platform.port = platform_.port();
    // A busy machine steps the test late.
    devices_.platform.valid_ms = 1000;
    devices_.platform.max_age_ticks = 1000;
  }
  template <typename Condition>
  bool ticks_until(DevicePlant& sut, MotionLeave leave, Condition condition) {
    return eventually([&] {
      sut.begin(trial_, ++tick_);
      rig::RigInput input{.leave = leave, .command_valid = true};
      auto output = sut.sample(input);
      sut.drive(input, output);
      return condition();
    });
  }
  /// The trial comes soon, as the lab announces it.
  void announce() {
    trial_ = {
        .number = 1, .phase = TrialPhase::kPegged, .start_tick = kFar, .duration_ticks = kFar};
  }

  static constexpr double kPlace_m = 0.07;
  EmulatedPlatform platform_{kPlace_m};
  DevicesConfig devices_;
  Trial trial_;
  Tick tick_ = 0;
};

TEST_F(SeatTest, WithoutATrialItStaysWhateverIsCommandedAndIsNotPrepared) {
  DevicePlant sut({}, devices_);
  int ticks = 0;
  EXPECT_TRUE(ticks_until(sut, MotionLeave::kFollow, [&] { return ++ticks > 1000; }));
  EXPECT_FALSE(platform_.followed());
  EXPECT_EQ(platform_.place_m(), kPlace_m);
  EXPECT_FALSE(sut.prepared());
  EXPECT_THAT(sut.unsound(), no_fault_but_of_the_machine());
}

TEST_F(SeatTest, AnAnnouncedTrialEngagesItAndSaysSo) {
  DevicePlant sut({}, devices_);
  announce();
  const char* notice = nullptr;
  EXPECT_TRUE(ticks_until(sut, MotionLeave::kEngage, [&] {
    if (const char* now = sut.notice()) notice = now;
    return platform_.place_m() == 0.0;
  }));
  EXPECT_TRUE(sut.prepared());
  EXPECT_STREQ(notice, "the platform engages: from +70 mm to the trial's place in 1.1 s");
}

TEST_F(SeatTest, AnotherProcessOrPlantDoesNotGetThePlatform) {
  const DevicePlant first({}, devices_);
  EXPECT_THROW(DevicePlant({}, devices_), ConfigError);
}

TEST_F(DevicePlantTest, AnAngleThatJumpsDisarmsForGood) {
  DevicePlant sut({}, devices_);
  announce(1, TrialPhase::kTracking);
  permitted_ = true;
  ASSERT_TRUE(ticks_until(sut, [&](const auto&) { return emulated_.record().commands > 5; }));
  emulated_.with([](auto& drive, auto&) { drive.sense({.position_rev = 3.0}); });
  EXPECT_TRUE(ticks_until(sut, [&](const auto&) { return sut.unsound() != nullptr; }));
  EXPECT_THAT(sut.unsound(), testing::HasSubstr("jumped"));
  announce(2, TrialPhase::kTracking);
  EXPECT_TRUE(ticks_until(sut, [&](const auto&) { return emulated_.torque_n_m() == 0.0; }));
  EXPECT_FALSE(sut.prepared());
}

}  // namespace stillhand::device_rig::device_plant_test
