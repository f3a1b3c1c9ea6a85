// SPDX-License-Identifier: Apache-2.0
#include "services/messages/motion/ride_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <utility>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/topics.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "tests/support/memory_bytes.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::motion::ride_file_test {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

std::string file_of(const std::string& name, const std::string& bytes) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

// A session's recording that holds these ticks; the lateral acceleration of each is its number.
std::string recording_of(const std::string& name, const std::vector<std::int64_t>& ticks) {
  recording::MemorySink sink;
  recording::McapWriter writer(sink);
  const auto schema = writer.add_schema("S", "omgidl", "struct S { octet x; };");
  const auto channel = writer.add_channel(std::string(topics::kSensed.name), schema, "cdr");
  for (const std::int64_t tick : ticks) {
    stillhand_msgs::Sensed message;
    message.tick(tick);
    message.accel_y_m_s2(static_cast<double>(tick));
    EXPECT_TRUE(writer.write(channel, 0, 0, 0, to_cdr(message)).ok());
  }
  EXPECT_TRUE(writer.close().ok());
  const auto bytes = sink.bytes();
  return file_of(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string error_of(const std::string& path) {
  return support::refusal([&] { (void)read_ride(path); });
}

TEST(RideFileTest, ACsvRideIsItsLateralColumnAtTheFilesRate) {
  const auto sut =
      read_ride(file_of("ride.csv", "t [s],a_x [m/s^2],a_y [m/s^2]\n0,9,1\n0.02,9,2\n0.04,9,-3\n"));
  EXPECT_THAT(sut.accel_m_s2, ElementsAre(1.0, 2.0, -3.0));
  EXPECT_DOUBLE_EQ(sut.rate_hz, 50.0);
  EXPECT_DOUBLE_EQ(sut.length_s(), 0.06);
}

// Steps of 14 and 6 ms are 10 ms on average; a rate from either would stretch the ride.
TEST(RideFileTest, TheRateOfUnevenRowsIsThatOfTheWholeRide) {
  EXPECT_DOUBLE_EQ(
      read_ride(file_of("uneven.csv", "t [s],a_y [m/s^2]\n0,1\n0.014,2\n0.02,3\n0.034,4\n0.04,5\n"))
          .rate_hz,
      100.0);
}

TEST(RideFileTest, ARecordingsRideIsWhatWasSensedAt1Khz) {
  const auto sut = read_ride(recording_of("whole.mcap", {7, 8, 9, 10}));
  EXPECT_THAT(sut.accel_m_s2, ElementsAre(7.0, 8.0, 9.0, 10.0));
  EXPECT_EQ(sut.rate_hz, 1000.0);
}

TEST(RideFileTest, AFewLostTicksAreBridgedByAStraightLine) {
  const auto sut = read_ride(recording_of("lost.mcap", {1, 2, 5, 6}));
  EXPECT_THAT(sut.accel_m_s2, ElementsAre(1.0, 2.0, DoubleEq(3.0), DoubleEq(4.0), 5.0, 6.0));
  EXPECT_EQ(read_ride(recording_of("ten.mcap", {1, 12})).accel_m_s2.size(), 12u);
}

TEST(RideFileTest, WhatIsNoRideIsRefusedWithItsReason) {
  // Halves at 10 and 13 ms: where they meet, rows are 20 times 1.5 ms from the grid of the average.
  std::string drift = "t [s],a_y [m/s^2]\n";
  for (int i = 0; i < 20; ++i) drift += std::to_string(0.010 * i) + ",1\n";
  for (int i = 0; i < 20; ++i) drift += std::to_string(0.200 + 0.013 * i) + ",1\n";
  const std::pair<std::string, const char*> cases[]{
      {file_of("drift.csv", drift), "not evenly spaced"},
      {recording_of("gap.mcap", {1, 2, 14}), "gap.mcap: got ticks missing after tick 2"},
      {recording_of("order.mcap", {1, 3, 2}), "after tick 3"},
      {recording_of("empty.mcap", {}), "no messages of stillhand/sensed"},
      {file_of("text.mcap", "t [s],a_y [m/s^2]\n"), "text.mcap"},
      {testing::TempDir() + "nowhere.mcap", "nowhere.mcap"}};
  for (const auto& [path, reason] : cases) EXPECT_THAT(error_of(path), HasSubstr(reason)) << path;
}

}  // namespace stillhand::motion::ride_file_test
