// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/read.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <set>
#include <utility>

#include "apps/libraries/measurement/read_options.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::read_test {

using diagnosis::Measurement;
using testing::HasSubstr;
using testing::StartsWith;

std::string file_of(const std::string& text) {
  const std::string path =
      testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

std::string error_of(const std::string& path, const ReadOptions& options = {}) {
  return support::refusal([&] { (void)read_measurement(path, options); });
}

// What is wrong with a table, without its path.
std::string complaint(const std::string& text) {
  const std::string path = file_of(text);
  const std::string error = error_of(path);
  return error.starts_with(path) ? error.substr(path.size()) : error;
}

// `count` good rows at 100 Hz, each passed through `change` with its number.
std::string table(
    int count, const std::function<std::string(int, std::string)>& change =
                   [](int, std::string row) { return row; }) {
  std::string text = "t [s],a_y [m/s^2],f [N],temp [degC]\n";
  for (int i = 0; i < count; ++i) {
    char row[80];
    std::snprintf(row, sizeof(row), "%.2f,%.4f,%.4f,21.5", i * 0.01, 0.1 * (i % 17),
                  -0.3 * (i % 13));
    text += change(i, row) + "\n";
  }
  return text;
}

TEST(ReadTest, ATableIsReadWithEveryChannelAndUnit) {
  const Measurement sut = read_measurement(file_of(table(100)));
  check(sut);
  EXPECT_EQ(sut.rate_hz, 100.0);
  EXPECT_EQ(sut.size(), 100u);
  ASSERT_EQ(sut.channels.size(), 3u);
  EXPECT_EQ(sut.channels[2].name, "temp");
  EXPECT_EQ(sut.channels[2].unit, "degC");
  EXPECT_DOUBLE_EQ(sut.find("f")->values[20], -0.3 * 7);
}

std::string with_titles(const std::string& titles) {
  std::string text = table(100);
  return titles + text.substr(text.find('\n'));
}

TEST(ReadTest, AChosenColumnIsReadInTheUnitInWhichAHandIsJudged) {
  const ReadOptions options{.channels = {{"Acc Y"}, "Grip force"}};
  const Measurement sut = read_measurement(
      file_of(with_titles("Time (s),Acc Y (g),Grip force (kN),temp (degC)")), options);
  EXPECT_EQ(sut.find("Acc Y")->unit, "m/s^2");
  EXPECT_DOUBLE_EQ(sut.find("Acc Y")->values[20], 0.1 * 3 * 9.80665);
  EXPECT_EQ(sut.find("Grip force")->unit, "N");
  EXPECT_DOUBLE_EQ(sut.find("Grip force")->values[20], -0.3 * 7 * 1000.0);
  EXPECT_EQ(sut.find("temp")->unit, "degC");
}

TEST(ReadTest, TitlesThatNameNoChannelOfTheModelComeWithTheWordsThatMapThem) {
  const Measurement sut =
      read_measurement(file_of(with_titles("Time (s),Acc Y (g),Grip force (N),temp (degC)")));
  const std::string error = support::refusal([&] { require_channels(sut, {"a_y", "f"}, {}); });
  EXPECT_THAT(error, HasSubstr("no channel 'a_y', want one of Acc Y, Grip force, temp; "));
  EXPECT_THAT(error,
              HasSubstr("--map 'Time (s)=t [s]' 'Acc Y (g)=a_y [g]' 'Grip force (N)=f [N]'"));
  require_channels(sut, {"Acc Y", "Grip force"}, {});
}

TEST(ReadTest, ANameThatNoMappingGivesIsTheFaultOfItsOption) {
  const Measurement sut =
      read_measurement(file_of(with_titles("t [s],a_y [m/s^2],f [N],T [degC]")));
  for (const std::string name : {"zz", "t", ""}) {
    EXPECT_EQ(
        support::refusal([&] { require_channels(sut, {"a_y", name}, {}, "--input, --output"); }),
        "--input, --output: got '" + name + "', no channel of " + sut.source +
            ", want one of a_y, f, T");
  }
}

TEST(ReadTest, AFolderIsNoMappingFile) {
  ReadOptions options;
  options.map_file = testing::TempDir();
  EXPECT_EQ(support::refusal([&] { (void)read_measurement(file_of(table(100)), options); }),
            "--map-file: got " + options.map_file + ", a folder, want a mapping file");
}

TEST(ReadTest, EveryReasonAgainstAModelHasAStepThatMendsIt) {
  EXPECT_THAT(step_for("unit"), HasSubstr("--map 'TITLE=NAME [UNIT]'"));
  EXPECT_THAT(step_for("filter"), HasSubstr("--order"));
  std::set<std::string> steps;
  for (const char* reason : {"unit", "sign", "swapped", "clocks", "samples", "copy", "unrelated"}) {
    EXPECT_TRUE(steps.insert(step_for(reason)).second) << reason;
  }
}

TEST(ReadTest, TheKindIsToldByTheContentNotTheName) {
  const std::string path = testing::TempDir() + "table.mcap";
  std::ofstream(path) << table(100);
  EXPECT_EQ(read_measurement(path).size(), 100u);
}

TEST(ReadTest, ATrialOfATableIsRefused) {
  EXPECT_THAT(error_of(file_of(table(100)), {"B"}), HasSubstr("--trial: got B with the table"));
}

TEST(ReadTest, AFileThatIsNotThereIsRefused) {
  EXPECT_THAT(error_of("/nowhere/ride.csv"), StartsWith("/nowhere/ride.csv: got No such file"));
  EXPECT_THAT(error_of(testing::TempDir()), HasSubstr("got a folder"));
}

TEST(ReadTest, WhatIsNoTableIsRefusedWithItsReasonAndItsLine) {
  const auto with_time = [](int at, const char* time_s) {
    return table(100,
                 [=](int i, std::string row) { return i == at ? time_s + row.substr(4) : row; });
  };
  const std::pair<std::string, testing::Matcher<std::string>> cases[]{
      {"", StartsWith(": got an empty file")},
      {"t [s]\n0\n0.01\n0.02\n", StartsWith(": got no column except the time")},
      {"f [N]\n0\n0.01\n0.02\n", HasSubstr("add --map 'f [N]=f [N]' --sample-rate HZ")},
      {"t [s],f [N]\n", StartsWith(": got no rows of numbers")},
      {table(10), StartsWith(": got 0 usable samples in 10 rows at 100 Hz")},
      {with_time(40, "0.39"), StartsWith(":42:1: got time 0.39 s, want more than 0.39 s")},
      {with_time(60, "0.12"), StartsWith(":62:1: got time 0.12 s, want more than 0.59 s")},
      {"Dear reader,\n\nthis is a letter.\n", HasSubstr("got no rows of numbers")},
      {std::string("\x7f\x45LF\0\1\2\3", 8), StartsWith(": got binary data")}};
  for (const auto& [text, reason] : cases) EXPECT_THAT(complaint(text), reason) << text;
}

// A recorder that sends a block again: rows 40 to 49 come twice, and so does row 99.
TEST(ReadTest, RowsThatAreThereTwiceAreLeftOutWithANote) {
  std::string block;
  const Measurement sut = read_measurement(file_of(table(200, [&](int i, std::string row) {
    if (i >= 40 && i < 50) block += "\n" + row;
    if (i == 49) return row + block;
    return i == 99 ? row + "\n" + row : row;
  })));
  check(sut);
  EXPECT_EQ(sut.size(), 200u);
  EXPECT_EQ(sut.stretches.size(), 1u);
  EXPECT_THAT(sut.notes, testing::Contains(HasSubstr("11 rows left out, equal to an earlier one")));
}

TEST(ReadTest, InfinityIsRefusedWithLineAndColumn) {
  for (const std::string cell : {"inf", "-Inf", "1e999", "1.#IND"}) {
    const auto spoil = [&](int i, std::string row) {
      return i == 70 ? "0.70," + cell + ",1,21.5" : row;
    };
    EXPECT_THAT(complaint(table(100, spoil)), StartsWith(":72:6: got '" + cell + "'"));
  }
}

TEST(ReadTest, ARowWithoutAValueIsMissingWithANote) {
  for (const std::string cell : {"", "nan", "NaN", "None"}) {
    const auto spoil = [&](int i, std::string row) {
      return i == 33 ? "0.33," + cell + ",1,21.5" : row;
    };
    const Measurement sut = read_measurement(file_of(table(100, spoil)));
    EXPECT_EQ(sut.weight[33], 0.0);
    EXPECT_THAT(sut.notes, testing::Contains(HasSubstr("1 of 100 rows lack a value (1 in a_y)")));
  }
}

TEST(ReadTest, AKnownNameInAnotherUnitIsConvertedOrRefused) {
  std::string text = table(100);
  text.replace(0, text.find('\n'), "t [s],a_y [g],f [N],temp [degC]");
  EXPECT_EQ(read_measurement(file_of(text)).find("a_y")->values[1], 0.1 * 9.80665);
  EXPECT_THAT(complaint("t [s],a_y [V],f [N]\n0,1,2\n1,1,2\n"),
              HasSubstr("got the unit V of 'a_y [V]', want a unit of a_y, such as m/s^2"));
}

// Slow sensors exist; the note is for those whose times are milliseconds.
TEST(ReadTest, RowsMayBeSecondsOrDaysApart) {
  for (const double step_s : {1.0, 60.0, 86400.0}) {
    std::string text = "t [s],temp [degC]\n";
    for (int i = 0; i < 100; ++i)
      text += std::to_string(step_s * i) + "," + std::to_string(i) + "\n";
    const Measurement sut = read_measurement(file_of(text));
    EXPECT_EQ(sut.size(), 100u);
    EXPECT_DOUBLE_EQ(sut.rate_hz, 1.0 / step_s);
    EXPECT_THAT(sut.notes, testing::Contains(HasSubstr("no motion of a hand shows")));
  }
}

// Milliseconds that a title or a mapping calls seconds.
TEST(ReadTest, AHandThatIsMeasuredEveryTenSecondsIsRefused) {
  std::string text = "t [s],f [N]\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(10 * i) + "," + std::to_string(i % 7) + "\n";
  const std::string path = file_of(text);
  EXPECT_THAT(error_of(path), HasSubstr(", time: got 10 s between rows of f, want at most 0.2 s; "
                                        "if the times are in another unit, of 100 Hz"));
  ReadOptions options;
  options.mapping.columns = {parse_wish("t [s]=t [ms]"), parse_wish("f=f")};
  EXPECT_EQ(read_measurement(path, options).rate_hz, 100.0);
  options.mapping.columns[0] = parse_wish("t [s]=t [s]");
  EXPECT_THAT(error_of(path, options), HasSubstr("got 10 s between rows of f"));
}

TEST(ReadTest, ACapitalThatIsAnotherChannelIsNoTime) {
  std::string text = "t [s],F [N],T [K]\n";
  for (int i = 0; i < 200; ++i) {
    text += std::to_string(0.01 * i) + "," + std::to_string(i % 7) + ",293\n";
  }
  const Measurement sut = read_measurement(file_of(text));
  ASSERT_EQ(sut.channels.size(), 2u);
  EXPECT_EQ(sut.channels[0].name, "f");
  EXPECT_EQ(sut.channels[1].name, "T");
}

// `stillhand export` writes all trials as one table.
TEST(ReadTest, TheSamplesOfAWholeSessionAreRefused) {
  std::string text = "t [s],acquired_ns [ns],accel_y_m_s2 [m/s^2],force_n [N]\n";
  for (int i = 0; i < 200; ++i) {
    text += std::to_string(0.01 * i) + ",1,0." + std::to_string(i % 7) + ",1\n";
  }
  ReadOptions options;
  options.mapping.columns = {parse_wish("t=t [s]"), parse_wish("accel_y_m_s2=a_y [m/s^2]"),
                             parse_wish("force_n=f [N]")};
  EXPECT_THAT(error_of(file_of(text), options), HasSubstr("got the samples of a session"));
  EXPECT_THAT(complaint(text), HasSubstr("got the samples of a session"));
}

// Windows-1252, as spreadsheets write it; characters that a strict reader of JSON refuses become
// others that it takes.
TEST(ReadTest, ATitleThatIsNoUtf8IsReadAsWindows1252) {
  const auto with = [](const std::string& odd) {
    std::string text = table(100);
    return text.replace(0, text.find('\n'), "t [s],a_y [m/s^2],f [N],temp [" + odd + "C]");
  };
  const Measurement sut = read_measurement(file_of(with("\xB0")));
  EXPECT_EQ(sut.channels[2].unit, "\u00B0C");
  EXPECT_THAT(sut.notes, testing::Contains("Text in WINDOWS-1252."));
  for (const char* odd : {"\xC0\xB0", "\xE0\x80\x80", "\xED\xA0\x80", "\xC3"}) {
    EXPECT_NE(read_measurement(file_of(with(odd))).channels[2].unit, std::string(odd) + "C");
  }
  EXPECT_THAT(complaint(with("\x81")), HasSubstr("text that is no WINDOWS-1252"));
  std::string good = table(100);
  good.replace(0, good.find('\n'), "t [s],\u0101_y [m/s\u00B2],\u20AC [\U0001F600],temp [\u00B0C]");
  EXPECT_EQ(read_measurement(file_of(good)).channels[2].unit, "\u00B0C");
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string in_utf16(const std::string& text, bool little) {
  std::string out;
  for (const char c : text) out += little ? std::string{c, '\0'} : std::string{'\0', c};
  return out;
}

// The same table, as other programs write it.
TEST(ReadTest, ATableInAnothersSignsIsTheSameTable) {
  const std::string good = table(100);
  const Measurement wanted = read_measurement(file_of(good));
  for (const std::string& text :
       {good + std::string(5000, '\0'), in_utf16(good, true), in_utf16(good, false),
        replaced(good, "\n", "\r"), replaced(good, "\n", "\r\n"), replaced(good, " [", "\u00A0["),
        replaced(good, ",-", ",\u2212")}) {
    const Measurement sut = read_measurement(file_of(text));
    ASSERT_EQ(sut.size(), wanted.size());
    EXPECT_EQ(sut.rate_hz, wanted.rate_hz);
    for (std::size_t i = 0; i < wanted.channels.size(); ++i) {
      EXPECT_EQ(sut.channels[i].name, wanted.channels[i].name);
      EXPECT_EQ(sut.channels[i].values, wanted.channels[i].values);
    }
  }
  EXPECT_THAT(read_measurement(file_of(good + std::string(7, '\0'))).notes,
              testing::Contains("7 zero bytes at the end are left out."));
  EXPECT_THAT(complaint(table(5) + std::string(9, '\0') + table(5)),
              StartsWith(":7: got binary data"));
}

TEST(ReadTest, AKindThatIsNotReadIsNamedWithTheLineThatConvertsIt) {
  struct Case {
    std::string bytes;
    const char* kind;
    const char* line;
  };
  for (const Case& each :
       {Case{std::string("SQLite format 3\0\1\2", 18), "rosbag2's .db3", "rosbags-convert"},
        Case{"\x28\xB5\x2F\xFD rest", "Zstandard", "zstd -d"},
        Case{"\x1F\x8B rest", "gzip", "gunzip"},
        Case{"PK\x03\x04 rest", "zip archive", "libreoffice --convert-to csv"},
        Case{"TDSh rest", "TDMS", ".tdms next to it"}, Case{"MDF     4.10", "ASAM", "asammdf"},
        Case{"#ROSBAG V2.0\n", "ROS 1", "rosbags-convert"}}) {
    const std::string error = complaint(each.bytes);
    EXPECT_THAT(error, HasSubstr(each.kind));
    EXPECT_THAT(error, HasSubstr(each.line));
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(ReadTest, StampsThatRowsShareNameTheRate) {
  const auto in_blocks = [](int i, std::string row) {
    return replaced(row, row.substr(0, row.find(',')), std::to_string(i / 10 * 10 / 100.0));
  };
  ReadOptions options;
  options.mapping.columns = {parse_wish("t [s]=t"), parse_wish("f [N]=f")};
  EXPECT_THAT(error_of(file_of(table(100, in_blocks)), options),
              HasSubstr("about --sample-rate 1"));
}

TEST(ReadTest, AHandWithinABlinkIsRefused) {
  const std::string ms = replaced(table(3000), "t [s]", "t [ms]");
  ReadOptions options;
  options.mapping.columns = {parse_wish("t [ms]=t"), parse_wish("f [N]=f")};
  EXPECT_THAT(error_of(file_of(ms), options), HasSubstr("--map 'TITLE=t * 1000'"));
  options.mapping.columns[0] = parse_wish("t [ms]=t * 1000");
  EXPECT_NEAR(read_measurement(file_of(ms), options).rate_hz, 100.0, 1e-9);
}

TEST(ReadTest, MoreThanAskedForIsRefusedBeforeItIsParsed) {
  const ReadOptions options{.most_values = 399};
  EXPECT_THAT(error_of(file_of(table(100)), options),
              HasSubstr("got 101 rows of 4 channels, want at most 399 values"));
}

}  // namespace stillhand::measurement::read_test
