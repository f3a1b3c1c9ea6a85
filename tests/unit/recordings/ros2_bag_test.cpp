// SPDX-License-Identifier: Apache-2.0
// Bags of ROS 2, read back by our own reader of its definitions;
// tests/interface/mcap_official_reader reads them with another program's.
#include "apps/recordings/ros2_bag.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "apps/recordings/export.hpp"
#include "tests/unit/recordings/sample_recording.hpp"

namespace stillhand::recordings::ros2_bag_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Pair;

std::string row_of(const std::string& file, int number) {
  std::ifstream stream(file);
  std::string line;
  for (int i = 0; i <= number; ++i) std::getline(stream, line);
  return line;
}

class Ros2BagTest : public FolderTest {};

TEST_F(Ros2BagTest, ASensedSampleIsAnImuAWrenchAndAJointWithYToTheLeft) {
  write_sample(path("a.mcap"));
  const Ros2Bag bag = write_ros2_bag(path("a.mcap"), path("bag.mcap"));
  EXPECT_THAT(bag.topics,
              ElementsAre(Pair("/diagnostics", 4U), Pair("/rig_1/hand/wrench", 200U),
                          Pair("/rig_1/imu", 200U), Pair("/rig_1/stick/joint_states", 200U)));
  EXPECT_EQ(bag.unread, 0U);
  // Rosbags passes over a channel of number 0.
  EXPECT_EQ(OpenRecording(path("bag.mcap")).reader.channels().begin()->first, 1);
  export_recording(path("bag.mcap"), {path("tables"), {}, {}, {}});
  // Force and torque, then acceleration and its covariance: x, y, z.
  EXPECT_THAT(row_of(path("tables/x_rig_1_hand_wrench.csv"), 61),
              EndsWith(",stick,0,-15.5,0,0,0,0"));
  EXPECT_THAT(row_of(path("tables/x_rig_1_imu.csv"), 61), EndsWith(",0,0.5,0,0,0,0,0,0,0,0,0,0"));
}

TEST_F(Ros2BagTest, WhatAReplayWroteIsLeftOut) {
  write_two_writers(path("a.mcap"), {{"replayed", "true"}});
  const Ros2Bag bag = write_ros2_bag(path("a.mcap"), path("bag.mcap"));
  EXPECT_THAT(bag.topics, Contains(Pair("/rig_1/imu", 3U)));
}

TEST_F(Ros2BagTest, ARecordingOfSomethingElseIsRefusedAndNoFileIsLeft) {
  write_sample(path("a.mcap"));
  write_ros2_bag(path("a.mcap"), path("bag.mcap"));
  const std::size_t files = file_count();
  EXPECT_THAT(support::refusal([&] { write_ros2_bag(path("bag.mcap"), path("again.mcap")); }),
              HasSubstr("no topic that a bag of ROS 2 would hold"));
  EXPECT_EQ(file_count(), files);
}

}  // namespace
}  // namespace stillhand::recordings::ros2_bag_test
