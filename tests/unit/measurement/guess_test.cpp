// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/guess.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/libraries/measurement/tables/suggestion.hpp"

namespace stillhand::measurement::guess_test {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

// A table whose columns all hold the same values.
class Table : public TableFile {
 public:
  explicit Table(TableHead head, std::vector<double> values = {})
      : TableFile(std::move(head)), values_(std::move(values)) {}
  RawColumns read(const std::vector<std::size_t>& columns) override {
    RawColumns out;
    out.values.assign(columns.size(), values_);
    return out;
  }

 private:
  std::vector<double> values_;
};

TableHead head_of(const std::vector<std::pair<std::string, std::string>>& columns) {
  TableHead head;
  for (const auto& [name, unit] : columns) head.columns.push_back({name, name, unit});
  return head;
}

std::vector<std::string> texts(const Mapping& mapping) {
  std::vector<std::string> out;
  for (const ColumnWish& wish : mapping.columns) out.push_back(wish_text(wish));
  return out;
}

TEST(GuessTest, ATitleIsTakenForWhatItsWordsBeginWith) {
  struct Case {
    const char* title;
    const char* unit;
    const char* channel;  // empty: resembles nothing
  };
  for (const Case& each : {Case{"Time", "", "t [s]"},
                           {"(t)", "", "t [s]"},
                           {"at t", "", "t [s]"},
                           {"sec", "", "t [s]"},
                           // One or two letters are the whole word.
                           {"t_1", "", ""},
                           {"af", "", ""},
                           {"zf", "", ""},
                           {"fa", "", ""},
                           {"axle", "", ""},
                           {"ax", "", "a_x [m/s^2]"},
                           {"impact", "", ""},
                           // The last axis that stands alone or ends a word; else the lateral one.
                           {"acc_z_max", "", "a_z [m/s^2]"},
                           {"acc", "", "a_y [m/s^2]"},
                           {"accx", "", "a_x [m/s^2]"},
                           {"acc_z", "", "a_z [m/s^2]"},
                           {"acc_w", "", "a_y [m/s^2]"},
                           {"acc_x_axis", "", "a_x [m/s^2]"},
                           {"acc_xa", "", "a_y [m/s^2]"},
                           {"acc_xzb", "", "a_y [m/s^2]"},
                           {"force", "", "f [N]"},
                           {"force_y", "", "f [N]"},
                           {"force_x", "", ""},
                           {"force_z", "", ""},
                           {"f_motor", "", "f_motor [N]"},
                           {"motor x", "", "f_motor [N]"},
                           // A unit of the column or the title that fits; else the channel's own.
                           {"acc", "g", "a_y [g]"},
                           {"acc_g", "", "a_y [g]"},
                           {"acc_g", "mm/s^2", "a_y [mm/s^2]"},
                           // A unit of another quantity would be refused.
                           {"acc_g", "V", ""},
                           {"angle deg", "", "theta [deg]"},
                           {"acc_V", "V", ""}}) {
    const auto guess =
        guess_column({each.title, each.title, each.unit}, 0, head_of({{each.title, each.unit}}));
    const std::string text = guess ? wish_text(*guess) : std::string(each.title) + "=";
    EXPECT_EQ(text, std::string(each.title) + "=" + each.channel);
  }
}

TEST(GuessTest, EachChannelIsGuessedOnceAndATimeOnlyOfAFileThatHasNone) {
  TableHead head = head_of({{"time", ""}, {"acc", ""}, {"acc", "g"}, {"force", ""}});
  EXPECT_THAT(texts(guess_mapping(head)),
              ElementsAre("time=t [s]", "#2=a_y [m/s^2]", "force=f [N]"));
  head.has_times = true;
  Mapping sut = guess_mapping(head);
  EXPECT_EQ(command_words(sut), "--map '#2=a_y [m/s^2]' 'force=f [N]'");
  sut.rate_hz = 0.5;
  EXPECT_THAT(command_words(sut), EndsWith("' --sample-rate 0.5"));
}

// As `stillhand export` writes two topics of ROS 2: the last part of a title counts most.
TEST(GuessTest, OfTitlesWithAPathTheLastPartSaysWhatTheColumnIs) {
  const TableHead head = head_of({{"imu/angular_velocity_covariance_0", ""},
                                  {"imu/header_stamp_sec", ""},
                                  {"imu/linear_acceleration_covariance_4", ""},
                                  {"imu/linear_acceleration_y", ""},
                                  {"imu/log_time", ""},
                                  {"imu/t", ""},
                                  {"stick_wrench/sequence", ""},
                                  {"stick_wrench/header_stamp_nanosec", ""},
                                  {"stick_wrench/wrench_force_x", ""},
                                  {"stick_wrench/wrench_force_y", ""}});
  EXPECT_THAT(texts(guess_mapping(head)),
              ElementsAre("imu/linear_acceleration_y=a_y [m/s^2]", "imu/t=t [s]",
                          "stick_wrench/wrench_force_y=f [N]"));
}

// The middle one of the steps; a column that steps by 1 alone may count, and is no time.
TEST(SuggestionTest, TimesWithoutAUnitAreInTheUnitOfTheirSteps) {
  const auto of = [](const std::vector<double>& times, const char* unit = "",
                     const char* title = "time") {
    Table table(head_of({{title, unit}, {"acc", ""}, {"force", ""}}), times);
    const Mapping sut = suggestion(table);
    return sut.columns.at(0).name == "t" ? sut.columns[0].unit : "";
  };
  for (const auto& [step, unit] : {std::pair(0.5, "s"),
                                   {1.0, ""},
                                   {2.0, "ms"},
                                   {999.0, "ms"},
                                   {1e3, "us"},
                                   {999e3, "us"},
                                   {1e6, "ns"}}) {
    EXPECT_EQ(of({0.0, step, 2.0 * step, 3.0 * step}), unit) << step;
  }
  EXPECT_EQ(of({0.0, 1.0, 2.0, 4.0}), "ms") << "not each step is 1";
  EXPECT_EQ(of({0.0, 2.0, 3.0, 4.0}), "ms");
  EXPECT_EQ(of({0.0, 0.0, 0.0, 0.0, 10.0, 20.0}), "ms") << "stamps that rows share have no step";
  EXPECT_EQ(of({3.0, 2.0, 1.0}), "s");
  EXPECT_EQ(of({0.0, 1e6, 2e6}, "s"), "s") << "as the file states";
  EXPECT_EQ(of({0.0, 1e6, 2e6}, "", "time_ms"), "ms") << "as the title states";
}

TEST(SuggestionTest, WhatIsMissingIsTheFirstColumnWhoseUnitFits) {
  TableHead head = head_of({{"p", "N"}, {"q", ""}, {"r", "g"}, {"s", ""}});
  const auto suggested = [&] {
    Table table(head, {0.0, 0.1});
    return texts(suggestion(table));
  };
  EXPECT_THAT(suggested(), ElementsAre("q=t [s]", "r=a_y [m/s^2]", "p=f [N]"));
  head.rate_hz = 0.5;
  EXPECT_THAT(suggested(), ElementsAre("q=a_y [m/s^2]", "p=f [N]"));
  head.rate_hz = 0.0;
  head.has_times = true;
  EXPECT_THAT(suggested(), ElementsAre("q=a_y [m/s^2]", "p=f [N]"));
}

TEST(SuggestionTest, ASampleRateIsAskedForWhereNothingStatesTheTime) {
  TableHead head = head_of({{"p", "N"}, {"q", "g"}});
  const auto asks = [&] {
    Table table(head);
    const std::string words = words_to_add(table);
    EXPECT_THAT(words, HasSubstr("'q=a_y [m/s^2]' 'p=f [N]'"));
    return words.find(" --sample-rate HZ (or") != std::string::npos;
  };
  EXPECT_TRUE(asks());
  head.rate_hz = 0.5;
  EXPECT_FALSE(asks());
  head.rate_hz = 0.0;
  head.has_times = true;
  EXPECT_FALSE(asks());
}

}  // namespace stillhand::measurement::guess_test
