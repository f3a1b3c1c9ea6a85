// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "apps/libraries/measurement/tables/guarded_table.hpp"
#include "apps/libraries/measurement/tables/in_child.hpp"
#include "tests/unit/measurement/foreign_bytes.hpp"

namespace stillhand::measurement::sound_reader_test {

using made::packed;
using testing::ElementsAre;

constexpr double kFullScale = 32768.0;

// RIFF of whole numbers of 16 bits at 100 Hz, row by row.
std::string wav(std::uint16_t channels, const std::vector<std::int16_t>& values) {
  std::string data;
  for (const std::int16_t each : values) data += packed(each);
  const auto bytes = static_cast<std::uint32_t>(data.size());
  const std::uint32_t rate_hz = 100;
  const std::uint16_t row_bytes = static_cast<std::uint16_t>(2 * channels);
  return "RIFF" + packed(36 + bytes) + "WAVEfmt " + packed(std::uint32_t{16}, std::uint16_t{1}) +
         packed(channels, rate_hz, rate_hz * row_bytes, row_bytes, std::uint16_t{16}) + "data" +
         packed(bytes) + data;
}

std::string file_of(const std::string& bytes) {
  std::string path = testing::TempDir() + "written.wav";
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

TEST(SoundReaderTest, EachChannelIsAColumnOfItsFullScale) {
  const std::string path = file_of(wav(2, {-32768, 16384, 8192, 0, 1, -1}));
  const TableHead head = sound_reader().head(path);
  ASSERT_EQ(head.columns.size(), 2U);
  EXPECT_EQ(head.columns[0].title, "channel 1");
  EXPECT_EQ(head.columns[1].title, "channel 2");
  EXPECT_EQ(head.columns[1].rows, 3U);
  EXPECT_EQ(head.rate_hz, 100.0);
  EXPECT_EQ(head.form, "Sound file of 100 Hz; full scale of whole numbers is 1");
  EXPECT_THAT(head.notes, ElementsAre());
  const RawColumns read = sound_reader().read(path, head, {1, 0});
  EXPECT_THAT(read.values.at(0), ElementsAre(0.5, 0.0, -1.0 / kFullScale));
  EXPECT_THAT(read.values.at(1), ElementsAre(-1.0, 0.25, 1.0 / kFullScale));
  EXPECT_THAT(read.notes, ElementsAre());
}

// Read in blocks of 4096 rows.
TEST(SoundReaderTest, ALongFileIsReadWhole) {
  std::vector<std::int16_t> values(2 * 4096 + 1);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::int16_t>(i);
  const std::string path = file_of(wav(1, values));
  const RawColumns read = sound_reader().read(path, sound_reader().head(path), {0});
  ASSERT_EQ(read.values.at(0).size(), values.size());
  EXPECT_EQ(read.values[0][4096], 4096.0 / kFullScale);
  EXPECT_EQ(read.values[0].back(), 8192.0 / kFullScale);
}

// The head states 36 + 8 bytes and the data; one byte may be the padding of an odd chunk.
TEST(SoundReaderTest, AFileThatIsCutOffIsNoted) {
  const std::string whole = wav(1, {1, 2, 3});
  const auto notes = [](const std::string& bytes) {
    return sound_reader().head(file_of(bytes)).notes;
  };
  EXPECT_THAT(notes(whole.substr(0, whole.size() - 1)), ElementsAre());
  EXPECT_THAT(notes(whole.substr(0, whole.size() - 2)),
              ElementsAre("The file is cut off: 48 of 50 bytes."));
  std::string piped = whole;
  piped.replace(4, 4, packed(std::uint32_t{0}));
  EXPECT_THAT(notes(piped), ElementsAre());
  piped.replace(4, 4, packed(UINT32_MAX));
  EXPECT_THAT(notes(piped), ElementsAre());
}

TEST(SoundReaderTest, WhatHasNoSamplesIsRefused) {
  const auto refused = [](const std::string& bytes) {
    try {
      (void)sound_reader().head(file_of(bytes));
    } catch (const Refused& error) {
      return error.want;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refused(wav(1, {})), "a sound file with samples");
  EXPECT_EQ(refused("RIFF"), "a sound file (WAV, FLAC, ...)");
  EXPECT_EQ(refused(wav(256, std::vector<std::int16_t>(256))), "accepted");
  EXPECT_EQ(refused(wav(257, std::vector<std::int16_t>(257))), "a sound file with samples");
}

}  // namespace stillhand::measurement::sound_reader_test
