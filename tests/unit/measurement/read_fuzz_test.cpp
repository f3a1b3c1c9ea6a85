// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/measurement/read.hpp"
#include "apps/libraries/measurement/tables/xdf_table.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/session_file.hpp"
#include "tests/unit/measurement/foreign_bytes.hpp"

// Valid files, spoilt by a seeded generator: each is read into a measurement that check() accepts,
// or refused with a ConfigError of one line.

namespace stillhand::measurement::read_fuzz_test {

using made::packed;
using made::xdf_chunk;
using Random = std::mt19937;

std::size_t below(Random& random, std::size_t limit) {
  return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
}

std::string good_table() {
  std::string text = "t [s],a_y [m/s^2],f [N]\n";
  for (int i = 0; i < 150; ++i) {
    if (i == 50 || i == 51 || (i > 70 && i < 80)) continue;
    char row[64];
    std::snprintf(row, sizeof(row), "%.3f,%.3f,%.3f\n", i * 0.01, 0.1 * (i % 7), 0.2 * (i % 5));
    text += row;
  }
  return text;
}

std::string good_session() {
  tests::SessionFile file(2048, recording::Compression::kNone);
  file.assignment(0, stillhand_msgs::MOTION_BAND_NOISE, false);
  file.control(0, stillhand_msgs::PHASE_PEGGED, 10, 80);
  for (int tick = 0; tick < 100; ++tick) file.sensed(tick);
  file.assignment(1, stillhand_msgs::MOTION_STILL, true);
  file.control(1, stillhand_msgs::PHASE_TRACKING, 100, 60);
  for (int tick = 100; tick < 160; ++tick) {
    file.sensed(tick);
    file.tracking(tick);
  }
  const auto bytes = file.close();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void replace_cell(std::string& text, Random& random) {
  constexpr std::array<const char*, 20> kCells{"1e308",  "-1e308", "1.7976931348623157e308",
                                               "5e-324", "1e-300", "9223372036854775808",
                                               "-0",     "",       "nan",
                                               "inf",    "1e999",  "0x10",
                                               "1,2",    "\"",     "1e18",
                                               "1e15",   "-1e15",  "1e5",
                                               "99",     "+-1"};
  const std::size_t at = below(random, text.size());
  const std::size_t begin = text.find_last_of(",\n", at);
  const std::size_t end = std::min(text.find_first_of(",\n", at + 1), text.size());
  const std::size_t first = begin == std::string::npos ? 0 : begin + 1;
  if (first >= end) return;
  text.replace(first, end - first, kCells[below(random, kCells.size())]);
}

void flip_byte(std::string& bytes, Random& random) {
  bytes[below(random, bytes.size())] ^= static_cast<char>(1u << below(random, 8));
}

// Cut off, or a piece taken out or doubled.
void cut(std::string& bytes, Random& random) {
  const std::size_t at = below(random, bytes.size());
  const std::size_t length = below(random, std::min<std::size_t>(bytes.size() - at, 300)) + 1;
  switch (below(random, 3)) {
    case 0:
      bytes.resize(at);
      break;
    case 1:
      bytes.erase(at, length);
      break;
    default:
      bytes.insert(below(random, bytes.size()), bytes.substr(at, length));
  }
}

// Eight bytes of a length, a tick or a number become an extreme one.
void plant_number(std::string& bytes, Random& random) {
  constexpr std::array<std::uint64_t, 7> kNumbers{0,
                                                  0x7fffffffffffffff,
                                                  0x8000000000000000,
                                                  0xffffffffffffffff,
                                                  0x7ff0000000000000,  // infinity
                                                  0x7fefffffffffffff,  // largest double
                                                  0x0000000100000000};
  if (bytes.size() < 8) return;
  const std::uint64_t number = kNumbers[below(random, kNumbers.size())];
  for (std::size_t i = 0, at = below(random, bytes.size() - 7); i < 8; ++i) {
    bytes[at + i] = static_cast<char>(number >> (8 * i));
  }
}

std::string spoilt_once(std::string bytes, Random& random) {
  switch (below(random, 3)) {
    case 0:
      flip_byte(bytes, random);
      break;
    case 1:
      cut(bytes, random);
      break;
    default:
      plant_number(bytes, random);
  }
  return bytes;
}

struct Count {
  int read = 0;
  int refused = 0;
};

void try_to_read(const std::string& path, const std::string& bytes, Count& count,
                 const ReadOptions& options) {
  // A new file each time: rewriting one waits for the disk.
  std::remove(path.c_str());
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    check(read_measurement(path, options));
    ++count.read;
  } catch (const ConfigError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    ++count.refused;
  }
}

void replace_sign(std::string& text, Random& random) {
  text.replace(below(random, text.size()), 1, 1, ";,. \"\n#-e\0"[below(random, 11)]);
}

// One to three spoils: a byte, a cut, or `other`, which is chosen in place of each of the `choices`
// beyond these.
std::string spoilt(std::string text, Random& random, std::size_t choices,
                   void (*other)(std::string&, Random&)) {
  for (std::size_t spoils = below(random, 3) + 1; spoils > 0 && !text.empty(); --spoils) {
    switch (below(random, choices)) {
      case 0:
        flip_byte(text, random);
        break;
      case 1:
        cut(text, random);
        break;
      default:
        other(text, random);
    }
  }
  return text;
}

/// Reads so many spoilt files of a name.  Both ends are reached more often than `read` and
/// `refused`, or the generator spoils too little or too much.
struct Campaign {
  const char* name;
  unsigned seed;
  int runs, read, refused;
  std::vector<const char*> wishes{};
};
void read_or_refuse(const Campaign& campaign, const std::vector<std::string>& good,
                    const std::function<std::string(std::string, Random&)>& spoil) {
  ReadOptions options;
  for (const char* wish : campaign.wishes) options.mapping.columns.push_back(parse_wish(wish));
  Random random(campaign.seed);
  Count count;
  for (const std::string& bytes : good) {
    ASSERT_FALSE(bytes.empty());
    for (int run = 0; run < campaign.runs; ++run) {
      SCOPED_TRACE("run " + std::to_string(run));
      ASSERT_NO_THROW(
          try_to_read(testing::TempDir() + campaign.name, spoil(bytes, random), count, options));
    }
  }
  EXPECT_GT(count.read, campaign.read);
  EXPECT_GT(count.refused, campaign.refused);
}

TEST(ReadFuzzTest, ASpoiltTableIsReadOrRefused) {
  read_or_refuse({"fuzz.csv", 20240601, 4000, 300, 400}, {good_table()},
                 [](std::string text, Random& random) {
                   return spoilt(std::move(text), random, 4, replace_cell);
                 });
}

// The same text with other signs and titles, which are looked for and mapped.
TEST(ReadFuzzTest, ASpoiltTableOfAnotherProgramIsReadOrRefused) {
  std::string good =
      "# made by a logger\nzeit;acc (g);kraft\n" + good_table().substr(good_table().find('\n') + 1);
  for (char& c : good) c = c == ',' ? ';' : c == '.' ? ',' : c;
  read_or_refuse(
      {"fuzz_foreign.csv", 20241125, 4000, 300, 300, {"zeit=t [s]", "acc=a_y", "kraft=f [N]"}},
      {good}, [](std::string text, Random& random) {
        return spoilt(std::move(text), random, 3, replace_sign);
      });
}

TEST(ReadFuzzTest, ASpoiltSessionIsReadOrRefused) {
  read_or_refuse({"fuzz.mcap", 20240602, 3000, 300, 300}, {good_session()},
                 [](std::string bytes, Random& random) {
                   return spoilt(std::move(bytes), random, 3, plant_number);
                 });
}

// Two streams of 150 samples.  The recorder's clock is 0.5 s ahead of the first one's and
// runs 1.001 times as fast as the second one's.
std::string good_xdf() {
  std::ostringstream file;
  file << "XDF:";
  for (std::uint32_t id = 1; id < 3; ++id) {
    std::ostringstream header;
    header << packed(id) << "<info><name>s" << id
           << "</name><channel_count>1</channel_count><nominal_srate>100</nominal_srate>"
              "<channel_format>double64</channel_format></info>";
    file << xdf_chunk(2, header.str());
  }
  const std::uint8_t one = 1, eight = 8;
  for (int i = 0; i < 150; ++i) {
    for (std::uint32_t id = 1; id < 3; ++id) {
      const double recorded = 70.0 + 0.01 * i;
      const double t = id == 1 ? recorded - 0.5 : recorded / 1.001;
      const double value = i % (5 + 2 * static_cast<int>(id)) * 0.1;
      file << xdf_chunk(3, packed(id, one, one, eight, t, value));
      if (i % 50 == 0) file << xdf_chunk(4, packed(id, t, recorded - t));
    }
  }
  return file.str();
}

TEST(ReadFuzzTest, ASpoiltXdfFileIsReadOrRefused) {
  const RawColumns read = xdf_table(good_xdf(), "good.xdf", 300)->read({0, 1});
  ASSERT_GE(read.time_s.size(), 149u);
  ASSERT_EQ(read.values.size(), 2u);
  for (std::size_t n = 1; n < 149; ++n) {  // the ends may lie outside of the second by a rounding
    EXPECT_NEAR(read.time_s[n], 0.01 * static_cast<double>(n), 1e-10);
    EXPECT_EQ(read.values[0][n], static_cast<double>(n % 7) * 0.1);
    EXPECT_NEAR(read.values[1][n], static_cast<double>(n % 9) * 0.1, 1e-9);
  }
  read_or_refuse({"fuzz.xdf", 20261127, 2000, 200, 200, {"s1.1=a_y [m/s^2]", "s2.1=f [N]"}},
                 {good_xdf()}, spoilt_once);
}

// Whole numbers of 32 bits, a row in 10 ms; those of "f" are 10 and half of the raw number.
std::string good_tdms(bool big_endian) {
  std::string file;
  for (int segment = 0; segment < 3; ++segment) {
    made::Tdms meta(big_endian);
    made::Tdms raw(big_endian);
    if (segment == 0) {
      meta.add(std::uint32_t{2}).object("/'g'/'a_y'", 3, 50, 1).number("wf_increment", 0.01);
      meta.object("/'g'/'f'", 3, 50, 5).number("wf_increment", 0.01);
      meta.whole("NI_Number_Of_Scales", 1).words("NI_Scale[0]_Scale_Type", "Linear");
      meta.number("NI_Scale[0]_Linear_Slope", 0.5).number("NI_Scale[0]_Linear_Y_Intercept", 10.0);
    }
    for (const int levels : {7, 5}) {
      for (int i = 50 * segment; i < 50 * segment + 50; ++i) raw.add(std::int32_t{i % levels});
    }
    file += meta.segment(segment == 0 ? 2u | 8u : 8u, raw.bytes());
  }
  return file;
}

TEST(ReadFuzzTest, ASpoiltTdmsFileIsReadOrRefused) {
  const std::string path = testing::TempDir() + "good.tdms";
  for (const bool big_endian : {false, true}) {
    std::ofstream(path, std::ios::binary) << good_tdms(big_endian);
    ReadOptions options;
    options.mapping.columns = {parse_wish("g.a_y=a_y [m/s^2]"), parse_wish("g.f=f [N]")};
    const diagnosis::Measurement read = read_measurement(path, options);
    ASSERT_EQ(read.size(), 150u);
    EXPECT_EQ(read.channels[0].values[55], 55 % 7);
    EXPECT_EQ(read.channels[1].values[149], 10.0 + 0.5 * (149 % 5));
  }
  read_or_refuse({"fuzz.tdms", 20261128, 1500, 200, 200, {"g.a_y=a_y [m/s^2]", "g.f=f [N]"}},
                 {good_tdms(false), good_tdms(true)}, spoilt_once);
}

}  // namespace stillhand::measurement::read_fuzz_test
