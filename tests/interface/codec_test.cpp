// SPDX-License-Identifier: Apache-2.0
// Every codec: each field arrives where it should.  Towards the bus the whole message is written
// out as the IDL lists it, so that a field added there and forgotten in a codec shows; rig and
// stamp_ns are the publisher's and stay 0.  From the bus a core's struct is taken apart completely,
// so that a field added there does not compile until it is looked at here.
#include "services/messages/cancellation/codec.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "services/messages/display/codec.hpp"
#include "services/messages/human_operator/codec.hpp"
#include "services/messages/motion/codec.hpp"
#include "services/messages/rig/codec.hpp"
#include "services/messages/sensing/codec.hpp"
#include "tests/support/idl_fields.hpp"

namespace stillhand {
namespace {

using tests::Fields;
using tests::fields_of;

stillhand_msgs::Sensed sensed_message() {
  stillhand_msgs::Sensed message;
  message.tick(7);
  message.acquired_ns(8);
  message.accel_y_m_s2(0.5);
  message.theta_rad(1.5);
  message.omega_rad_s(2.5);
  message.flags(9);
  return message;
}

TEST(RigCodecTest, EveryFieldOfARawSampleIsTheRigs) {
  rig::RigOutput output{};
  output.raw = {0.5, 1.5, 2.5, 3.5, -4, 5.5};
  output.flags = 2;
  output.motor_flags = 4;
  EXPECT_EQ(fields_of(rig::to_idl(output, 7)), (Fields{{"rig", "0"},
                                                       {"tick", "7"},
                                                       {"stamp_ns", "0"},
                                                       {"accel_x_v", "0.5"},
                                                       {"accel_y_v", "1.5"},
                                                       {"accel_z_v", "2.5"},
                                                       {"load_cell_v", "3.5"},
                                                       {"encoder_counts", "-4"},
                                                       {"roll_rad", "5.5"},
                                                       {"flags", "6"}}));
}

TEST(RigCodecTest, EveryFieldOfTheTruthIsTheRigs) {
  rig::RigOutput output{};
  output.truth = {0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5};
  output.flags = 1;
  output.motor_flags = 8;
  rig::RigInput input{.pegged = true};
  const Fields wanted{{"rig", "0"},
                      {"tick", "10"},
                      {"stamp_ns", "0"},
                      {"platform_position_m", "0.5"},
                      {"platform_velocity_m_s", "1.5"},
                      {"platform_acceleration_m_s2", "2.5"},
                      {"theta_rad", "3.5"},
                      {"omega_rad_s", "4.5"},
                      {"feedthrough_force_n", "5.5"},
                      {"motor_force_n", "6.5"},
                      {"volitional_force_n", "7.5"},
                      {"hand_force_n", "8.5"},
                      {"command_tick", "11"},
                      {"motor_tick", "12"},
                      {"operator_tick", "13"},
                      {"pegged", "true"},
                      {"motor_permitted", "false"},
                      {"flags", "9"}};
  EXPECT_EQ(fields_of(rig::to_idl(output, 10, input, {11, 12, 13})), wanted);
  input.pegged = false;
  input.motor_permitted = true;
  const auto fields = fields_of(rig::to_idl(output, 10, input, {11, 12, 13}));
  EXPECT_EQ(fields.at(15).second, "false");
  EXPECT_EQ(fields.at(16).second, "true");
}

TEST(RigCodecTest, AnInputHoldsWhatTheMessagesSayAndTheirAge) {
  stillhand_msgs::PlatformCommand command;
  command.position_m(0.5);
  command.velocity_m_s(1.5);
  command.acceleration_m_s2(2.5);
  stillhand_msgs::MotorCommand motor;
  motor.tick(98);
  motor.force_n(3.5);
  stillhand_msgs::OperatorForce volition;
  volition.tick(95);
  volition.force_n(4.5);
  const auto [leave, cv, cx, cs, ca, mv, mage, mf, ov, oage, of, pegged, permitted] =
      rig::make_input(100, &command, &motor, &volition, true, false);
  EXPECT_EQ(leave, MotionLeave::kFollow) << "no message says it: the shell does";
  EXPECT_EQ(std::tuple(cv, cx, cs, ca), std::tuple(true, 0.5, 1.5, 2.5));
  EXPECT_EQ(std::tuple(mv, mage, mf), std::tuple(true, 2, 3.5));
  EXPECT_EQ(std::tuple(ov, oage, of), std::tuple(true, 5, 4.5));
  EXPECT_EQ(std::tuple(pegged, permitted), std::tuple(true, false));
}

TEST(RigCodecTest, AnInputWithoutMessagesIsInvalidInEachPart) {
  const auto input = rig::make_input(100, nullptr, nullptr, nullptr, false, true);
  EXPECT_FALSE(input.command_valid || input.motor_valid || input.operator_valid || input.pegged);
  EXPECT_TRUE(input.motor_permitted);
}

TEST(RigCodecTest, AnAgeThatDoesNotFitIsTooOld) {
  stillhand_msgs::MotorCommand motor;
  stillhand_msgs::OperatorForce volition;
  motor.tick(std::numeric_limits<std::int64_t>::min());
  volition.tick(-5);
  constexpr Tick kLast = std::numeric_limits<Tick>::max();
  const auto input = rig::make_input(kLast - 2, nullptr, &motor, &volition, false, true);
  EXPECT_EQ(input.motor_age_ticks, kLast);
  EXPECT_EQ(input.operator_age_ticks, kLast);
}

TEST(SensingCodecTest, EveryFieldOfARawSampleReachesTheCore) {
  stillhand_msgs::RawSample message;
  message.tick(7);
  message.accel_x_v(0.5);
  message.accel_y_v(1.5);
  message.accel_z_v(2.5);
  message.load_cell_v(3.5);
  message.encoder_counts(-4);
  message.roll_rad(5.5);
  const auto [tick, x, y, z, cell, counts, roll] = sensing::from_idl(message);
  EXPECT_EQ(std::tuple(tick, x, y, z, cell, counts, roll),
            std::tuple(7, 0.5, 1.5, 2.5, 3.5, -4, 5.5));
}

TEST(SensingCodecTest, EveryFieldOfASensedSampleIsSet) {
  stillhand_msgs::RawSample raw;
  raw.tick(7);
  raw.stamp_ns(8);
  EXPECT_EQ(fields_of(sensing::to_idl({0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 9}, raw)),
            (Fields{{"rig", "0"},
                    {"tick", "7"},
                    {"stamp_ns", "0"},
                    {"acquired_ns", "8"},
                    {"accel_x_m_s2", "0.5"},
                    {"accel_y_m_s2", "1.5"},
                    {"accel_z_m_s2", "2.5"},
                    {"roll_rad", "3.5"},
                    {"force_n", "4.5"},
                    {"theta_rad", "5.5"},
                    {"omega_rad_s", "6.5"},
                    {"flags", "9"}}));
}

TEST(MotionCodecTest, EveryFieldOfAPlatformCommandIsSet) {
  EXPECT_EQ(fields_of(motion::to_idl({0.5, 1.5, 2.5, 3}, 4, 5)),
            (Fields{{"rig", "0"},
                    {"tick", "4"},
                    {"stamp_ns", "0"},
                    {"position_m", "0.5"},
                    {"velocity_m_s", "1.5"},
                    {"acceleration_m_s2", "2.5"},
                    {"trial", "5"},
                    {"flags", "3"}}));
}

TEST(MotionCodecTest, AnAssignmentAndItsTrialMakeAProfile) {
  stillhand_msgs::TrialAssignment message;
  message.motion(stillhand_msgs::MOTION_ROAD);
  message.band_low_hz(0.5);
  message.band_high_hz(1.5);
  message.band_order(3);
  message.rms_m_s2(2.5);
  message.peak_m_s2(3.5);
  message.motion_seed(4);
  const Trial trial{.duration_ticks = 5, .ramp_ticks = 6};
  const auto [kind, seed, low, high, order, rms, peak, duration, ramp, speed, road, rate, ride,
              tones] = motion::from_idl(message, trial);
  EXPECT_EQ(std::tuple(low, high, order, rms, peak), std::tuple(0.5, 1.5, 3, 2.5, 3.5));
  EXPECT_EQ(std::tuple(kind, seed, duration, ramp), std::tuple(motion::MotionKind::kRoad, 4, 5, 6));
  // These are not on the bus and keep their defaults.
  const motion::MotionProfile fresh;
  EXPECT_EQ(std::tuple(speed, road, rate), std::tuple(fresh.road_speed_m_s, fresh.road_class, 0.0));
  EXPECT_TRUE(ride.empty() && tones.empty());
}

TEST(MotionCodecTest, EveryKindOfMotionKeepsItsName) {
  const std::pair<stillhand_msgs::MotionKind, const char*> kinds[]{
      {stillhand_msgs::MOTION_STILL, "still"},
      {stillhand_msgs::MOTION_BAND_NOISE, "band_noise"},
      {stillhand_msgs::MOTION_MULTISINE, "multisine"},
      {stillhand_msgs::MOTION_ROAD, "road"},
      {stillhand_msgs::MOTION_RIDE, "ride"}};
  for (const auto& [kind, name] : kinds) {
    stillhand_msgs::TrialAssignment message;
    message.motion(kind);
    EXPECT_EQ(motion::to_string(motion::from_idl(message, {}).kind), name);
  }
  stillhand_msgs::TrialAssignment newer;
  for (const int bad : {static_cast<int>(stillhand_msgs::MOTION_RIDE) + 1, -1, 256}) {
    newer.motion(static_cast<stillhand_msgs::MotionKind>(bad));
    EXPECT_EQ(motion::from_idl(newer, {}).kind, motion::MotionKind::kStill) << bad;
  }
}

TEST(CancellationCodecTest, EveryFieldOfASensedSampleReachesTheCore) {
  stillhand_msgs::Sensed message = sensed_message();
  message.accel_x_m_s2(0.1);
  message.accel_z_m_s2(0.2);
  message.roll_rad(0.3);
  const auto [tick, sensed, flags, enabled, permitted, trial] =
      cancellation::from_idl(message, true, false);
  EXPECT_EQ(tick, 7);
  EXPECT_EQ(trial.number, Trial().number);  // the newest is not in a sample
  EXPECT_EQ(sensed, (cancellation::ChannelSample{0.1, 0.5, 0.2, 0.3, 1.5, 2.5}));
  EXPECT_EQ(flags, 9u);
  EXPECT_EQ(std::tuple(enabled, permitted), std::tuple(true, false));
}

TEST(CancellationCodecTest, EveryFieldOfAMotorCommandIsSet) {
  const auto command = [](bool enabled, bool permitted) {
    const auto input = cancellation::from_idl(sensed_message(), enabled, permitted);
    return fields_of(cancellation::to_idl({3.5, 4.5, 10, {0.75, 0.125}, 0.5, 1.25}, input,
                                          sensed_message(), 11, 13));
  };
  EXPECT_EQ(command(true, false), (Fields{{"rig", "0"},
                                          {"tick", "7"},
                                          {"stamp_ns", "0"},
                                          {"acquired_ns", "8"},
                                          {"force_n", "3.5"},
                                          {"predicted_force_n", "4.5"},
                                          {"gain_weight", "0.75"},
                                          {"phase_weight", "0.125"},
                                          {"model", "11"},
                                          {"enabled", "true"},
                                          {"permitted", "false"},
                                          {"flags", "10"},
                                          {"taken_off_rad", "1.25"},
                                          {"mitigated_trial", "13"}}));
  EXPECT_EQ(command(false, true).at(9).second, "false");
  EXPECT_EQ(command(false, true).at(10).second, "true");
}

TEST(DisplayCodecTest, WhatAMitigationTakesOffReachesTheCore) {
  stillhand_msgs::MotorCommand command;
  command.tick(5);
  command.taken_off_rad(0.25);
  const auto [tick, theta, off] = display::from_idl(sensed_message(), display::from_idl(command));
  EXPECT_EQ(off, 0.25);
  EXPECT_EQ(display::from_idl(command).tick, 5);
}

TEST(DisplayCodecTest, TickAndAngleReachTheCore) {
  const auto [tick, theta_rad, taken_off_rad] = display::from_idl(sensed_message());
  EXPECT_EQ(std::tuple(tick, theta_rad, taken_off_rad), std::tuple(7, 1.5, 0.0));
}

TEST(DisplayCodecTest, EveryFieldOfATrackingSampleIsSet) {
  EXPECT_EQ(fields_of(display::to_idl({0.5, 1.5, true, 2}, 3, 4, 5)),
            (Fields{{"rig", "0"},
                    {"tick", "3"},
                    {"stamp_ns", "0"},
                    {"target_m", "0.5"},
                    {"cursor_m", "1.5"},
                    {"inside", "true"},
                    {"trial", "4"},
                    {"flags", "2"},
                    {"command_tick", "5"}}));
}

TEST(DisplayCodecTest, EveryFieldOfAPromptReachesTheScreen) {
  stillhand_msgs::Prompt message;
  message.number(5);
  message.kind(stillhand_msgs::PROMPT_QUESTION);
  message.trial(4);
  message.trials(12);
  message.end_tick(170'000);
  message.text("first\nsecond\n");
  message.lowest("not at all");
  message.highest("very");
  message.steps(7);
  const auto [number, kind, trial, trials, end_tick, lines, lowest, highest, steps] =
      display::from_idl(message);
  EXPECT_EQ(
      std::tuple(number, kind, trial, trials, end_tick, lowest, highest, steps),
      std::tuple(5u, display::PromptKind::kQuestion, 4, 12, 170'000, "not at all", "very", 7));
  EXPECT_EQ(lines, (std::vector<std::string>{"first", "second"}));
  for (const int bad : {-1, 10, 1'000'000}) {
    message.steps(bad);
    EXPECT_EQ(display::from_idl(message).steps, 0) << bad;
  }
  for (const int bad : {static_cast<int>(stillhand_msgs::PROMPT_END) + 1, -1, 256}) {
    message.kind(static_cast<stillhand_msgs::PromptKind>(bad));
    EXPECT_EQ(display::from_idl(message).kind, display::PromptKind::kNothing) << bad;
  }
}

TEST(DisplayCodecTest, EveryFieldOfAnAnswerIsSet) {
  EXPECT_EQ(fields_of(display::to_idl(display::Answering::Answer{5, 7})),
            (Fields{{"rig", "0"}, {"stamp_ns", "0"}, {"prompt_number", "5"}, {"value", "7"}}));
}

TEST(HumanOperatorCodecTest, EveryFieldOfATrackingSampleReachesTheCore) {
  stillhand_msgs::TrackingSample message;
  message.tick(7);
  message.target_m(0.5);
  message.cursor_m(1.5);
  const auto [tick, target_m, cursor_m, active, felt_m_s2] =
      human_operator::from_idl(message, true, 2.5);
  EXPECT_EQ(std::tuple(tick, target_m, cursor_m, active, felt_m_s2),
            std::tuple(7, 0.5, 1.5, true, 2.5));
}

TEST(HumanOperatorCodecTest, EveryFieldOfAForceIsSet) {
  EXPECT_EQ(fields_of(human_operator::to_idl({0.5, 2}, {3, 0.0, 0.0, true}, 4)),
            (Fields{{"rig", "0"},
                    {"tick", "3"},
                    {"stamp_ns", "0"},
                    {"force_n", "0.5"},
                    {"active", "true"},
                    {"trial", "4"},
                    {"flags", "2"}}));
}

}  // namespace
}  // namespace stillhand
