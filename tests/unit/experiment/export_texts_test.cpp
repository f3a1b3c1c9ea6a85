// SPDX-License-Identifier: Apache-2.0
// Texts of a data set next to the standard's lists of words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "apps/experiment/export/bids_texts.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::experiment::export_texts_test {
namespace {

recording::Recording tracking_rows() {
  recording::Recording rows;
  rows.rate_hz = 1000.0;
  rows.time_s.assign(5000, 0.0);
  rows.columns = {{"a_x", "m/s^2", {}}, {"a_y", "m/s^2", {}}, {"a_z", "m/s^2", {}},
                  {"roll", "rad", {}},  {"theta", "rad", {}}, {"omega", "rad/s", {}},
                  {"f", "N", {}},       {"f_motor", "N", {}}, {"x_r", "m", {}},
                  {"x_p", "m", {}}};
  return rows;
}

TEST(ExportTextsTest, EveryChannelHasAWordOfTheStandard) {
  // BIDS 1.11.1, "Restricted keyword list for channel type" and "for channel component".
  const std::set<std::string> types{"ACCEL", "ANGACCEL", "GYRO", "JNTANG", "LATENCY",
                                    "MAGN",  "MISC",     "ORNT", "POS",    "VEL"};
  const std::set<std::string> components{"x", "y", "z", "n/a"};
  for (const auto& column : tracking_rows().columns) {
    EXPECT_TRUE(types.contains(channel_of(column.name).type)) << column.name;
    EXPECT_TRUE(components.contains(channel_of(column.name).component)) << column.name;
  }
  EXPECT_THROW(channel_of("grip"), ConfigError);
}

TEST(ExportTextsTest, TheSideFileCountsTheChannelsOfEachType) {
  ExportedTrial trial;
  const auto sut = nlohmann::json::parse(motion_json(Design{}, trial, tracking_rows()));
  EXPECT_EQ(sut.at("ACCELChannelCount"), 3);
  EXPECT_EQ(sut.at("ORNTChannelCount"), 2);
  EXPECT_EQ(sut.at("GYROChannelCount"), 1);
  EXPECT_EQ(sut.at("MISCChannelCount"), 2);
  EXPECT_EQ(sut.at("POSChannelCount"), 2);
  EXPECT_EQ(sut.at("MotionChannelCount"), 10);
  EXPECT_EQ(sut.at("TrackedPointsCount"), 5);
  EXPECT_EQ(sut.at("SamplingFrequency"), 1000.0);
  EXPECT_EQ(sut.at("RecordingDuration"), 5.0);
  EXPECT_EQ(sut.at("TaskName"), "tracking");
}

TEST(ExportTextsTest, ChannelsAreInTheOrderOfTheColumnsWithTheirUnits) {
  std::istringstream lines(channels_tsv(tracking_rows()));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "name\tcomponent\ttype\ttracked_point\tunits\tsampling_frequency\tdescription");
  std::getline(lines, line);
  EXPECT_THAT(line, testing::StartsWith("a_x\tx\tACCEL\tPlatform\tm/s^2\t1000\t"));
  for (int n = 0; n < 6; ++n) std::getline(lines, line);
  EXPECT_THAT(line, testing::StartsWith("f\tn/a\tMISC\tHand\tN\t1000\t"));
}

TEST(ExportTextsTest, TheDescriptionHasWhatTheStandardRequires) {
  Release release;
  const auto bare = nlohmann::json::parse(dataset_description(Design{}, release));
  EXPECT_EQ(bare.at("BIDSVersion"), kBidsVersion);
  EXPECT_EQ(bare.at("DatasetType"), "raw");
  EXPECT_EQ(bare.at("License"), "not stated; ask the authors");
  EXPECT_FALSE(bare.contains("Authors"));
  release.authors = {"The Laboratory"};
  EXPECT_EQ(nlohmann::json::parse(dataset_description(Design{}, release)).at("Authors").size(), 1u);
}

}  // namespace
}  // namespace stillhand::experiment::export_texts_test
