// SPDX-License-Identifier: Apache-2.0
// Signs and stamps of ROS 2: y is left there and right here.
#include "apps/libraries/ros2/converter.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"

namespace stillhand::recordings::converter_test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pair;

constexpr std::uint64_t kTime_ns = 12'000'000'345;

// A message of ROS 2, read behind its header.
class Reader {
 public:
  explicit Reader(std::vector<std::byte>& cdr)
      : buffer_(reinterpret_cast<char*>(cdr.data()), cdr.size()), cdr_(buffer_) {
    cdr_.read_encapsulation();
    std::int32_t s = 0;
    std::uint32_t ns = 0;
    std::string frame;
    cdr_ >> s >> ns >> frame;
    EXPECT_EQ(s, 12);
    EXPECT_EQ(ns, 345U);
  }

  std::vector<double> numbers(std::size_t count) {
    std::vector<double> out(count);
    for (double& each : out) cdr_ >> each;
    return out;
  }

  // Of the one status: its level, its name, what it says and its values.
  std::string status() {
    std::uint32_t count = 0, values = 0;
    std::uint8_t level = 9;
    std::string name, message, hardware, key, value;
    cdr_ >> count >> level >> name >> message >> hardware >> values;
    EXPECT_EQ(count, 1U);
    std::string out = std::to_string(level) + " " + name + ": " + message;
    for (std::uint32_t i = 0; i < values; ++i) {
      cdr_ >> key >> value;
      out += "; " + key + "=" + value;
    }
    return out;
  }

  std::pair<double, double> joint() {
    std::vector<std::string> names;
    std::vector<double> position, velocity;
    cdr_ >> names >> position >> velocity;
    return {position.at(0), velocity.at(0)};
  }

 private:
  eprosima::fastcdr::FastBuffer buffer_;
  fast_cdr::PlainCdr cdr_;
};

template <typename Sent>
std::vector<ros2::Message> from(const topics::Topic& topic, Sent sent) {
  sent.rig(7);
  auto out = ros2::converted(topic.name, to_cdr(sent), kTime_ns);
  return out.value();
}

TEST(ConverterTest, ForceAndPointsToTheRightAreMinusY) {
  stillhand_msgs::MotorCommand command;
  command.force_n(3.5);
  auto wrench = from(topics::kMotorCommand, command);
  ASSERT_EQ(wrench.size(), 1U);
  EXPECT_EQ(wrench[0].topic, "/rig_7/motor/wrench");
  EXPECT_THAT(Reader(wrench[0].cdr).numbers(6), ElementsAre(0, -3.5, 0, 0, 0, 0));

  stillhand_msgs::TrackingSample sample;
  sample.target_m(0.25);
  sample.cursor_m(-0.125);
  auto points = from(topics::kTrackingSample, sample);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_THAT(Reader(points[0].cdr).numbers(3), ElementsAre(0, -0.25, 0));
  EXPECT_THAT(Reader(points[1].cdr).numbers(3), ElementsAre(0, 0.125, 0));
}

TEST(ConverterTest, APlatformToTheRightIsAJointToMinusY) {
  stillhand_msgs::PlatformCommand command;
  command.position_m(0.5);
  command.velocity_m_s(-0.25);
  auto joint = from(topics::kPlatformCommand, command);
  ASSERT_EQ(joint.size(), 1U);
  EXPECT_THAT(Reader(joint[0].cdr).joint(), Pair(-0.5, 0.25));
}

// Roll and theta turn about x in both; a rotation by r is the quaternion (sin r/2, 0, 0, cos r/2).
TEST(ConverterTest, ASensedSampleTurnsAboutXAndLeavesToTheLeft) {
  stillhand_msgs::Sensed sensed;
  sensed.roll_rad(0.2);
  sensed.accel_x_m_s2(1.0);
  sensed.accel_y_m_s2(2.0);
  sensed.accel_z_m_s2(3.0);
  sensed.force_n(-4.0);
  sensed.theta_rad(0.1);
  sensed.omega_rad_s(-0.3);
  auto all = from(topics::kSensed, sensed);
  ASSERT_EQ(all.size(), 3U);
  const std::vector<double> imu = Reader(all[0].cdr).numbers(37);
  EXPECT_THAT(std::span(imu).subspan(0, 5),
              ElementsAre(DoubleNear(std::sin(0.1), 1e-15), 0, 0, DoubleNear(std::cos(0.1), 1e-15),
                          0));  // a covariance behind it
  EXPECT_EQ(imu[16], -1.0);     // the angular velocity is not measured
  for (std::size_t i = 5; i < 37; ++i) {
    if (i == 16 || (i >= 25 && i <= 27)) continue;
    EXPECT_EQ(imu[i], 0.0) << i;
  }
  EXPECT_THAT(std::span(imu).subspan(25, 4), ElementsAre(1, -2, 3, 0));
  EXPECT_THAT(Reader(all[1].cdr).numbers(3), ElementsAre(0, 4, 0));
  EXPECT_THAT(Reader(all[2].cdr).joint(), Pair(0.1, -0.3));
}

// diagnostic_msgs: 0 is good, 1 a warning, 2 an error.
TEST(ConverterTest, AStatusIsAsBadAsTheWorstOfIt) {
  const auto says = [](const std::vector<std::array<std::uint64_t, 3>>& lost_missed_late,
                       const char* missing, auto state) {
    stillhand_msgs::ServiceStatus status;
    status.service("rig");
    status.tick(-1);
    status.missing(missing);
    status.state(state);
    for (const auto& [lost, missed, late] : lost_missed_late) {
      auto& topic = status.topics().emplace_back();
      topic.topic("t");
      topic.lost_ticks(lost);
      topic.deadline_misses(missed);
      topic.cycle_misses(late);
    }
    auto& read = status.topics().emplace_back(stillhand_msgs::TopicStatus{});
    read.topic("r");
    read.samples(1);
    read.latency_p99_us(0.5);
    auto& written = status.topics().emplace_back(read);
    written.written(true);
    return Reader(from(topics::kServiceStatus, status).at(0).cdr).status();
  };
  const auto numbers = [](const char* missing, int lost, int missed, int late) {
    return "; tick=-1; missing=" + std::string(missing) +
           "; r latency p99 [us]=0.5; lost ticks=" + std::to_string(lost) +
           "; deadline misses=" + std::to_string(missed) + "; late cycles=" + std::to_string(late);
  };
  constexpr auto kRunning = stillhand_msgs::SERVICE_RUNNING;
  EXPECT_EQ(says({}, "", kRunning), "0 /rig_7/rig: runs" + numbers("", 0, 0, 0));
  EXPECT_EQ(says({{0, 0, 3}, {0, 0, 4}}, "", kRunning),
            "0 /rig_7/rig: runs" + numbers("", 0, 0, 7));
  EXPECT_EQ(says({{1, 0, 0}, {2, 0, 0}}, "", kRunning),
            "1 /rig_7/rig: runs" + numbers("", 3, 0, 0));
  EXPECT_EQ(says({{0, 1, 0}, {0, 3, 0}}, "", kRunning),
            "1 /rig_7/rig: runs" + numbers("", 0, 4, 0));
  EXPECT_EQ(says({}, "lab", kRunning), "1 /rig_7/rig: runs" + numbers("lab", 0, 0, 0));
  EXPECT_EQ(says({}, "", stillhand_msgs::SERVICE_FAULT),
            "2 /rig_7/rig: fault" + numbers("", 0, 0, 0));
}

TEST(ConverterTest, AnEventWarnsUnlessItIsANoteOrACommand) {
  for (const auto& [kind, level] : {std::pair(stillhand_msgs::EVENT_NOTE, "0"),
                                    {stillhand_msgs::EVENT_COMMAND, "0"},
                                    {stillhand_msgs::EVENT_TICKS_LOST, "1"}}) {
    stillhand_msgs::Event event;
    event.kind(kind);
    event.source("lab");
    event.text("x");
    event.topic("t");
    event.peer("p");
    EXPECT_EQ(Reader(from(topics::kEvent, event).at(0).cdr).status(),
              std::string(level) + " /rig_7/lab/event: x; topic=t; peer=p");
  }
}

TEST(ConverterTest, WhatIsNoMessageOfATopicIsNothingAndAnotherTopicHasNone) {
  const std::vector<std::byte> three(3);
  EXPECT_FALSE(ros2::converted(topics::kSensed.name, three, kTime_ns));
  EXPECT_TRUE(ros2::converted("another", three, kTime_ns).value().empty());
  EXPECT_EQ(ros2::sources().size(), 6U);
  EXPECT_EQ(ros2::dds_type(ros2::kImu), "sensor_msgs::msg::dds_::Imu_");
}

}  // namespace
}  // namespace stillhand::recordings::converter_test
