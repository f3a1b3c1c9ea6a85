// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/clock_steps.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <tuple>

#include "tests/support/recorded_file.hpp"

namespace stillhand::recording::clock_steps_test {
namespace {

using tests::Bytes;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1'000 * kMs;
constexpr std::int64_t kStart = 1'795'272'703 * kSecond;  // [ns] time of day; the stamps begin at 0

/// What every 1 kHz message begins with.
Bytes sample(std::int64_t tick, std::int64_t stamp_ns) {
  Bytes bytes(28);
  bytes[1] = std::byte{1};
  std::memcpy(bytes.data() + 12, &tick, sizeof(tick));
  std::memcpy(bytes.data() + 20, &stamp_ns, sizeof(stamp_ns));
  return bytes;
}

/// Steps of the clock, and all log times as they should be: `clock` gives the log time of what is
/// received `n` ms after the start.
struct Recorded {
  MemorySink sink;
  McapWriter writer{sink, {2000, Compression::kNone, "stillhand-test"}};
  ChannelId stream = 0, other = 0;

  explicit Recorded(std::int64_t set_by_ns, const TextMap& qos = {{"qos_profile", "stream_1khz"}},
                    TextMap session = {}) {
    session["clock_offset_ns at start"] = "5";
    EXPECT_TRUE(writer.add_metadata("stillhand.session", session).ok());
    const std::string end = std::to_string(5 + set_by_ns);
    EXPECT_TRUE(writer.add_metadata("stillhand.counts", {{"clock_offset_ns at end", end}}).ok());
    stream = writer.add_channel("stillhand/sensed", 0, "cdr", qos);
    other = writer.add_channel("stillhand/event", 0, "cdr");
  }
  void put(ChannelId channel, std::int64_t log_ns, const Bytes& bytes) {
    EXPECT_TRUE(writer.write(channel, 0, static_cast<std::uint64_t>(log_ns), 0, bytes).ok());
  }
  void put(std::int64_t tick, std::int64_t log_ns) {
    put(stream, log_ns, sample(tick, tick * kMs));
  }
};

/// Log times [ms] since kStart, rounded, and the steps.
std::pair<std::vector<std::int64_t>, std::vector<ClockStep>> read(const Bytes& file) {
  MemorySource source(file);
  McapReader sut(source);
  std::vector<std::int64_t> times_ms;
  std::uint64_t start = UINT64_MAX, end = 0;
  for (const auto& message : tests::messages_of(sut)) {
    times_ms.push_back((static_cast<std::int64_t>(message.log_time_ns) - kStart + kMs / 2) / kMs);
    start = std::min(start, message.log_time_ns);
    end = std::max(end, message.log_time_ns);
  }
  EXPECT_EQ(sut.statistics().start_time_ns, start);
  EXPECT_EQ(sut.statistics().end_time_ns, end);
  // Through the index, second by second, the same messages come.
  std::size_t count = 0;
  for (std::uint64_t from = start; from <= end; from += kSecond) {
    count += tests::messages_of(sut, {{}, from, from + kSecond - 1}).size();
  }
  EXPECT_EQ(count, times_ms.size());
  return {times_ms, sut.clock_steps()};
}

auto closed(Recorded& recorded) {
  EXPECT_TRUE(recorded.writer.close().ok());
  return read(recorded.sink.bytes());
}

std::vector<std::int64_t> counted(std::int64_t count) {
  std::vector<std::int64_t> times_ms;
  for (std::int64_t n = 0; n < count; ++n) times_ms.push_back(n);
  return times_ms;
}

class ClockStepsTest : public testing::TestWithParam<std::tuple<double, bool>> {};

TEST_P(ClockStepsTest, LogTimesAreReadAsIfNobodyHadSetTheClock) {
  const auto by_ns = static_cast<std::int64_t>(std::get<0>(GetParam()) * 1e9);
  Recorded recorded(by_ns);
  for (std::int64_t n = 0; n < 4000; ++n) {
    recorded.put(n, kStart + n * kMs + (n >= 2000 ? by_ns : 0));
  }
  if (std::get<1>(GetParam())) {
    ASSERT_TRUE(recorded.writer.close().ok());
  }
  const auto [times_ms, steps] = read(recorded.sink.bytes());
  std::vector<std::int64_t> want = counted(4000);
  want.resize(times_ms.size());  // of a file that was not closed, the open chunk is lost
  EXPECT_EQ(times_ms, want);
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_EQ(steps[0].by_ns, by_ns);
  EXPECT_EQ(steps[0].at_ns, static_cast<std::uint64_t>(kStart + 2000 * kMs));
}

INSTANTIATE_TEST_SUITE_P(
    BackAndForward, ClockStepsTest,
    testing::Combine(testing::Values(-3600.0, -0.25, -0.03, 0.25, 10.0, 3600.0), testing::Bool()));

TEST(ClockStepsTest, StepsThatTakeEachOtherBackAreFoundByTheOrderOfTheChunks) {
  Recorded recorded(0);
  const auto set = [](std::int64_t n) { return n >= 1000 && n < 2500 ? -2 * kSecond : 0; };
  for (std::int64_t n = 0; n < 4000; ++n) recorded.put(n, kStart + n * kMs + set(n));
  const auto [times_ms, steps] = closed(recorded);
  EXPECT_EQ(times_ms, counted(4000));
  EXPECT_EQ(steps.size(), 2u);
}

TEST(ClockStepsTest, AMessageThatAnotherThreadQueuedLateKeepsItsPlace) {
  Recorded recorded(-kSecond);
  for (std::int64_t n = 0; n < 3000; ++n) {
    // Stamped before the step and queued behind it, and the other way round.
    if (n == 1502) recorded.put(recorded.other, kStart + 1499 * kMs, {});
    if (n == 1499) recorded.put(recorded.other, kStart + 1500 * kMs - kSecond, {});
    recorded.put(n, kStart + n * kMs - (n >= 1500 ? kSecond : 0));
  }
  const auto [times_ms, steps] = closed(recorded);
  EXPECT_EQ(steps.size(), 1u);
  EXPECT_EQ(times_ms[1499], 1500);
  EXPECT_EQ(times_ms[1503], 1499);
}

// A recorder of today logs by a clock that cannot step: nothing is taken out, however the system's
// was set, and whatever the bus does.
TEST(ClockStepsTest, APauseOrARecorderThatStoodStillIsNoStep) {
  for (const std::int64_t set_by_ns : {10 * kSecond, -10 * kSecond, kSecond}) {
    Recorded recorded(set_by_ns);
    std::vector<std::int64_t> want;
    const auto put = [&](std::int64_t n, std::int64_t at_ms) {
      recorded.put(n, kStart + at_ms * kMs);
      want.push_back(at_ms);
    };
    for (std::int64_t n = 0; n < 1000; ++n) put(n, n);
    for (std::int64_t n = 1000; n < 2000; ++n) put(n, 2000);  // a second's worth had waited
    for (std::int64_t n = 2001; n < 2500; ++n) put(n, n);
    // 34 ms had waited, and it catches up by 1 ms in four samples.
    for (std::int64_t n = 2500; n < 3000; ++n) {
      put(n, n + std::max<std::int64_t>(0, 34 - (n - 2500) / 4));
    }
    for (std::int64_t n = 13'000; n < 14'000; ++n) put(n, n);  // nothing was sent for 10 s
    const auto [times_ms, steps] = closed(recorded);
    EXPECT_EQ(times_ms, want);
    EXPECT_TRUE(steps.empty());
  }
}

// It says by which clock it logs, and no jump of its times is one of the system's clock.
TEST(ClockStepsTest, ARecorderThatNamesItsClockIsBelieved) {
  Recorded recorded(-kSecond, {{"qos_profile", "stream_1khz"}}, {{"log_clock", "monotonic"}});
  std::vector<std::int64_t> want;
  for (std::int64_t n = 0; n < 2000; ++n) {
    want.push_back(1000 + n - (n >= 1000 ? 1000 : 0));
    recorded.put(n, kStart + want.back() * kMs);
  }
  const auto [times_ms, steps] = closed(recorded);
  EXPECT_EQ(times_ms, want);
  EXPECT_TRUE(steps.empty());
}

TEST(ClockStepsTest, AStepAtTheEndIsDecidedByWhatTheRecorderNoted) {
  for (const std::int64_t noted_ns : {10 * kSecond, 7 * kSecond}) {
    Recorded recorded(noted_ns);
    for (std::int64_t n = 0; n < 1100; ++n) {
      recorded.put(n, kStart + n * kMs + (n >= 1000 ? 10 * kSecond : 0));
    }
    EXPECT_EQ(closed(recorded).second.size(), noted_ns == 10 * kSecond ? 1u : 0u);
  }
}

// Its stamps are those of the session that was played: at another rate they run apart.
TEST(ClockStepsTest, AReplayShowsNoStep) {
  Recorded recorded(kSecond, {{"qos_profile", "stream_1khz"}, {"replayed", "true"}});
  for (std::int64_t n = 0; n < 2000; ++n) recorded.put(n, kStart + n * kMs * 3);
  EXPECT_TRUE(closed(recorded).second.empty());
}

TEST(ClockStepsTest, WithoutSamplesAStepBackLosesAnIntervalAtMost) {
  Recorded recorded(-3600 * kSecond);
  for (std::int64_t n = 0; n < 100; ++n) {
    recorded.put(recorded.other, kStart + n * 10 * kMs - (n >= 50 ? 3600 * kSecond : 0), {});
  }
  const auto [times_ms, steps] = closed(recorded);
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_TRUE(std::ranges::is_sorted(times_ms));
  EXPECT_EQ(times_ms.back(), 980);
}

// Other programs may write what they like, and so may a file that steps all the time.
TEST(ClockStepsTest, TimesThatAreNoRecordersClockStayAsTheyAre) {
  Recorded recorded(-kSecond);
  std::vector<std::int64_t> want;
  for (std::int64_t n = 0; n < 12'000; ++n) {
    want.push_back(1000 + n - 1000 * (n / 300 % 2));
    recorded.put(n, kStart + want.back() * kMs);
  }
  const auto [times_ms, steps] = closed(recorded);
  EXPECT_EQ(times_ms, want);
  EXPECT_TRUE(steps.empty());
}

}  // namespace
}  // namespace stillhand::recording::clock_steps_test
