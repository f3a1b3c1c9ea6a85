// SPDX-License-Identifier: Apache-2.0
// Signs and stamps of ROS 2: y is left there and right here.
#include "apps/libraries/ros2/converter.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
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
  EXPECT_THAT(std::span(imu).subspan(25, 4), ElementsAre(1, -2, 3, 0));
  EXPECT_THAT(Reader(all[1].cdr).numbers(3), ElementsAre(0, 4, 0));
  EXPECT_THAT(Reader(all[2].cdr).joint(), Pair(0.1, -0.3));
}

}  // namespace
}  // namespace stillhand::recordings::converter_test
