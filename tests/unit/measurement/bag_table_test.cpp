// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/bag_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "apps/libraries/measurement/read.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/cdr_bytes.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::bag_table_test {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;

constexpr std::int32_t kEpoch_s = 1'700'000'000;

constexpr std::size_t kChunk_bytes = 100'000;  // 2 to 3 s of both sensors at 100 Hz

// A ROS 2 recording with an IMU at 100 Hz and a force sensor at 200 Hz, 2.5 ms later.
class Bag {
 public:
  explicit Bag(const std::string& path,
               recording::Compression compression = recording::Compression::kZstd)
      : sink_(path, recording::Existing::kReplace), writer_(sink_, options(compression)) {
    const auto imu = writer_.add_schema("sensor_msgs/msg/Imu", "ros2msg", tests::imu_definition());
    imu_ = writer_.add_channel("/imu/data", imu, "cdr");
    const auto wrench =
        writer_.add_schema("geometry_msgs/msg/WrenchStamped", "ros2msg",
                           "std_msgs/Header header\nWrench wrench\n===\nMSG: geometry_msgs/Wrench\n"
                           "Vector3 force\nVector3 torque\n===\nMSG: geometry_msgs/Vector3\n"
                           "float64 x\nfloat64 y\nfloat64 z\n===\nMSG: std_msgs/Header\n"
                           "builtin_interfaces/Time stamp\nstring frame_id\n");
    wrench_ = writer_.add_channel("/stick/wrench", wrench, "cdr");
    writer_.add_channel("/chatter", 0, "json");
  }

  void imu(std::int64_t time_ns, double a_y, bool stamped = true) {
    tests::CdrBytes message = head(stamped ? time_ns : -1);
    for (int i = 0; i < 4 + 9 + 3 + 9; ++i) message.put(0.0);
    message.put(0.0).put(a_y).put(9.81);
    for (int i = 0; i < 9; ++i) message.put(0.0);
    write(imu_, time_ns, message);
  }
  void wrench(std::int64_t time_ns, double f_y) {
    tests::CdrBytes message = head(time_ns);
    message.put(1.0).put(f_y).put(2.0).put(0.0).put(0.0).put(0.0);
    write(wrench_, time_ns, message);
  }
  void close() { ASSERT_TRUE(writer_.close().ok()); }

 private:
  static recording::McapWriterOptions options(recording::Compression compression) {
    recording::McapWriterOptions options;
    options.profile = "ros2";
    options.compression = compression;
    options.chunk_bytes = kChunk_bytes;
    return options;
  }
  static tests::CdrBytes head(std::int64_t time_ns) {
    tests::CdrBytes message;
    const bool stamped = time_ns >= 0;
    message.put(stamped ? static_cast<std::int32_t>(kEpoch_s + time_ns / 1'000'000'000) : 0);
    message.put(stamped ? static_cast<std::uint32_t>(time_ns % 1'000'000'000) : 0U);
    message.text("base");
    return message;
  }
  // It arrives 3 ms after its stamp.
  void write(recording::ChannelId channel, std::int64_t time_ns, const tests::CdrBytes& message) {
    const auto log_ns = static_cast<std::uint64_t>(kEpoch_s) * 1'000'000'000ULL +
                        static_cast<std::uint64_t>(time_ns) + 3'000'000ULL;
    ASSERT_TRUE(writer_.write(channel, 0, log_ns, log_ns, message.bytes()).ok());
  }

  recording::FileSink sink_;
  recording::McapWriter writer_;
  recording::ChannelId imu_ = 0;
  recording::ChannelId wrench_ = 0;
};

std::string path_of(const char* name) { return testing::TempDir() + name; }

// Where the chunks of an MCAP file begin: a record is its kind, the length of its content in 8
// bytes, and its content (MCAP specification, "Records").
std::vector<std::size_t> chunks_of(const std::string& bytes) {
  constexpr std::size_t kHead = 9;
  constexpr char kChunk = 6;
  std::vector<std::size_t> out;
  std::uint64_t length = 0;
  for (std::size_t at = 8; at + kHead < bytes.size(); at += kHead + length) {
    std::memcpy(&length, bytes.data() + at + 1, sizeof length);
    if (bytes[at] == kChunk) out.push_back(at);
  }
  return out;
}

void write_bytes(const std::string& path, const std::string& bytes) {
  ASSERT_TRUE(recording::write_file_atomically(path, bytes).ok());
}

std::string error_of(const std::string& path, const ReadOptions& options = {}) {
  return support::refusal([&] { (void)read_measurement(path, options); });
}

ReadOptions mapped(const std::vector<const char*>& wishes) {
  ReadOptions options;
  for (const char* wish : wishes) options.mapping.columns.push_back(parse_wish(wish));
  return options;
}

TEST(BagTableTest, TwoTopicsComeToTheTimesOfTheFirst) {
  const std::string path = path_of("two.mcap");
  Bag bag(path);
  const auto force = [](double t) { return 5.0 * std::sin(6.0 * t); };
  for (std::int64_t i = 0; i < 200; ++i) {
    bag.imu(i * 10'000'000, 0.1 * static_cast<double>(i % 7));
    for (const std::int64_t ns : {i * 10'000'000 + 2'500'000, i * 10'000'000 + 7'500'000}) {
      bag.wrench(ns, force(1e-9 * static_cast<double>(ns)));
    }
  }
  bag.close();
  const auto sut = read_measurement(
      path, mapped({"/imu/data.linear_acceleration.y=a_y", "/stick/wrench.wrench.force.y=f"}));
  EXPECT_EQ(sut.rate_hz, 100.0);
  EXPECT_EQ(sut.size(), 199u) << "the first row is before the first force";
  ASSERT_EQ(sut.channels.size(), 2u);
  EXPECT_EQ(sut.channels[0].unit, "m/s^2");
  EXPECT_EQ(sut.channels[1].unit, "N");
  EXPECT_EQ(sut.channels[0].values[0], 0.1);
  for (std::size_t n = 1; n + 1 < sut.size(); ++n) {
    // A cubic over steps of h: at most 3/128 (w h)^4 times the amplitude, (6 * 0.005)^4 * 5 *
    // 0.024.
    const double t = 0.01 * static_cast<double>(n + 1);
    ASSERT_NEAR(sut.channels[1].values[n], force(t), 1e-7) << n;
  }
  EXPECT_THAT(sut.notes, Contains(HasSubstr("/stick/wrench are taken at the times of /imu/data")));
}

TEST(BagTableTest, OneTopicIsReadValueByValueInTheOrderOfItsStamps) {
  const std::string path = path_of("one.mcap");
  Bag bag(path);
  for (std::int64_t i = 0; i < 100; ++i) {
    const std::int64_t shuffled = i % 10 == 3 ? i + 1 : i % 10 == 4 ? i - 1 : i;
    bag.imu(shuffled * 10'000'000, 0.25 * static_cast<double>(shuffled));
  }
  bag.imu(990'000'000, 24.75);  // twice
  bag.close();
  const auto sut = read_measurement(path, mapped({"/imu/data.linear_acceleration.y=a_y"}));
  ASSERT_EQ(sut.size(), 100u);
  for (std::size_t n = 0; n < sut.size(); ++n) {
    EXPECT_EQ(sut.channels[0].values[n], 0.25 * static_cast<double>(n));
  }
  EXPECT_EQ(sut.stretches[0].start_s, 0.0);
  EXPECT_THAT(sut.notes, Contains(HasSubstr("1 messages of /imu/data left out")));
}

TEST(BagTableTest, WithoutAStampTheTimeOfRecordingCounts) {
  const std::string path = path_of("unstamped.mcap");
  Bag bag(path);
  for (std::int64_t i = 0; i < 100; ++i) bag.imu(i * 10'000'000, static_cast<double>(i), false);
  bag.close();
  EXPECT_EQ(read_measurement(path, mapped({"/imu/data.linear_acceleration.y=a_y"})).rate_hz, 100.0);
}

TEST(BagTableTest, WithoutAMappingItIsRefusedWithOne) {
  const std::string path = path_of("unmapped.mcap");
  Bag bag(path);
  for (std::int64_t i = 0; i < 100; ++i) {
    bag.imu(i * 10'000'000, 1.0);
    bag.wrench(i * 10'000'000, 1.0);
  }
  bag.close();
  const std::string sut = error_of(path);
  EXPECT_THAT(sut, HasSubstr("'/imu/data.linear_acceleration.y=a_y [m/s^2]'"));
  EXPECT_THAT(sut, HasSubstr("'/stick/wrench.wrench.force.y=f [N]'"));
  EXPECT_EQ(sut.find('\n'), std::string::npos);
}

TEST(BagTableTest, AFileWithoutSuchMessagesIsRefused) {
  const std::string path = path_of("json.mcap");
  {
    recording::FileSink sink(path, recording::Existing::kReplace);
    recording::McapWriter writer(sink);
    writer.add_channel("/json", 0, "json");
    ASSERT_TRUE(writer.close().ok());
  }
  EXPECT_THAT(error_of(path), HasSubstr("no topic to read (/json: got messages in 'json'"));
}

TEST(BagTableTest, OfAFileWhoseMessagesAreAllLostTheLossIsSaid) {
  const std::string path = path_of("all_lost.mcap");
  Bag bag(path);
  bag.imu(0, 1.0);
  bag.close();
  const std::string whole = recording::read_file(path);
  write_bytes(path, whole.substr(0, chunks_of(whole)[0] + 50));
  EXPECT_THAT(error_of(path), HasSubstr("without messages (" + path + ": cut off, as after a"));
}

// The clock of the recording machine is set back by 5 s in the middle.
void write_step_back(Bag& bag) {
  for (std::int64_t i = 0; i < 2000; ++i) {
    const std::int64_t time_ns = i * 10'000'000 - (i < 1000 ? 0 : 5'000'000'000) + 1'000'000'000;
    bag.imu(time_ns, 1e-3 * static_cast<double>(i) + 0.1 * static_cast<double>(i % 3));
    bag.wrench(time_ns, static_cast<double>(i % 7) + 1e-3 * static_cast<double>(i));
  }
  bag.close();
}

TEST(BagTableTest, StampsThatGoBackBeginANewStretchAndAreNamed) {
  const std::string path = path_of("back.mcap");
  Bag bag(path);
  write_step_back(bag);
  const auto sut = read_measurement(
      path, mapped({"/imu/data.linear_acceleration.y=a_y", "/stick/wrench.wrench.force.y=f"}));
  ASSERT_EQ(sut.stretches.size(), 2u);
  EXPECT_EQ(sut.size(), 2000u);
  EXPECT_DOUBLE_EQ(sut.rate_hz, 100.0);
  // In the order in which they came.
  EXPECT_DOUBLE_EQ(sut.find("a_y")->values[1000], 1.0 + 0.1 * (1000 % 3));
  ASSERT_EQ(sut.screening.size(), 1u);
  EXPECT_EQ(sut.screening[0].what, "time_goes_back");
  EXPECT_NEAR(sut.screening[0].times_s[0], 9.99, 1e-9);
}

TEST(BagTableTest, StampsThatGoBackInOneTopicAloneAreRefused) {
  const std::string path = path_of("back_alone.mcap");
  Bag bag(path);
  for (std::int64_t i = 0; i < 400; ++i) {
    bag.imu(i * 10'000'000, 0.1 * static_cast<double>(i % 7));
    bag.wrench(i * 10'000'000 - (i < 200 ? 0 : 1'000'000'000) + 1'000'000'000,
               static_cast<double>(i % 5));
  }
  bag.close();
  EXPECT_THAT(error_of(path, mapped({"/imu/data.linear_acceleration.y=a_y",
                                     "/stick/wrench.wrench.force.y=f"})),
              HasSubstr("time stamps that go back, but not those of /imu/data"));
}

// Whichever chunk it is, also the one that held the instants to which the stamps go back.
TEST(BagTableTest, OfADamagedFileTheLossIsSaidAndStampsThatGoBackAreStillFound) {
  const std::string path = path_of("damaged.mcap");
  Bag bag(path);
  write_step_back(bag);
  const std::string whole = recording::read_file(path);
  const std::vector<std::size_t> chunks = chunks_of(whole);
  ASSERT_GT(chunks.size(), 6u);
  for (const std::size_t chunk : chunks) {
    std::string damaged = whole;
    damaged[chunk + 100] ^= 1;
    write_bytes(path, damaged);
    const auto sut = read_measurement(
        path, mapped({"/imu/data.linear_acceleration.y=a_y", "/stick/wrench.wrench.force.y=f"}));
    EXPECT_THAT(sut.notes, Contains(AllOf(HasSubstr("Loss: "), HasSubstr("chunk lost")))) << chunk;
    EXPECT_THAT(sut.screening, Contains(Field(&diagnosis::SampleFault::what, "time_goes_back")))
        << chunk;
  }
}

TEST(BagTableTest, AChangedByteShowsInTheChecksumOfTheWholeFileWhereAChunkHasNone) {
  const std::string path = path_of("no_checksum.mcap");
  Bag bag(path, recording::Compression::kNone);
  write_step_back(bag);
  std::string bytes = recording::read_file(path);
  // In the content of a chunk: two times and a size of 8 bytes each, and then the checksum.
  const std::size_t checksum = chunks_of(bytes)[1] + 9 + 24;
  bytes.replace(checksum, 4, 4, '\0');
  write_bytes(path, bytes);
  const auto sut = read_measurement(path, mapped({"/imu/data.linear_acceleration.y=a_y"}));
  EXPECT_THAT(sut.notes, Contains(AllOf(HasSubstr("Loss: "), HasSubstr("data section differs"))));
}

}  // namespace stillhand::measurement::bag_table_test
