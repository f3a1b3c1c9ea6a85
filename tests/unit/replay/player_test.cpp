// SPDX-License-Identifier: Apache-2.0
// The player against the machine's own clock.  Every bound on a time is one that a late wake-up
// cannot break.
#include "apps/replay/player.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <numeric>

#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/system/process/clock.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::replay::player_test {
namespace {

using recording::HeldMessage;
using runtime::monotonic_ns;
using support::eventually;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;
// Log times as of 2026: a difference of two doubles of this size would be off by 256 ns.
constexpr std::int64_t kStart = 1'780'000'000'000'000'007;
constexpr int kCount = 41;
constexpr std::int64_t kEnd = kStart + (kCount - 1) * kMs;

/// A recording of 41 messages, 1 ms apart; the content of each is its number.
class PlayerTest : public testing::Test {
 protected:
  PlayerTest() {
    recording::FileSink sink(path(), recording::Existing::kReplace);
    recording::McapWriter writer(sink, {});
    writer.add_channel("a", 0, "cdr");
    for (int i = 0; i < kCount; ++i) {
      const std::byte content{static_cast<unsigned char>(i)};
      EXPECT_TRUE(
          writer.write(0, 0, static_cast<std::uint64_t>(kStart + i * kMs), 0, {&content, 1}).ok());
    }
    EXPECT_TRUE(writer.close().ok());
    file_ = std::make_unique<recording::FileSource>(path());
  }
  [[nodiscard]] std::string path() const { return (folder_ / "f.mcap").string(); }

  Player& player(std::int64_t per_mille = 1000, bool loop = false, std::int64_t first_ns = kStart,
                 std::int64_t last_ns = kEnd, std::vector<recording::ChannelId> wanted = {0},
                 std::vector<recording::ChannelId> latched = {}) {
    source_ = std::make_unique<MessageSource>(*file_, wanted, latched);
    sut_ = std::make_unique<Player>(
        *source_, static_cast<std::uint64_t>(first_ns), static_cast<std::uint64_t>(last_ns),
        recording::PlayRate{per_mille}, loop,
        [this](const HeldMessage& message, std::span<const std::byte> content) {
          released_.push_back(std::to_integer<int>(content.front()));
          at_ns_.push_back(monotonic_ns());
          due_ns_.push_back(static_cast<std::int64_t>(message.log_time_ns));
        });
    return *sut_;
  }
  /// Steps until the replay is over.
  void play_to_the_end() {
    ASSERT_TRUE(eventually([&] { return !sut_->step().has_value(); }));
  }
  /// Steps until so many messages were released.
  void play(std::size_t count) {
    ASSERT_TRUE(eventually([&] {
      sut_->step();
      return released_.size() >= count;
    }));
  }
  static std::vector<int> numbers(int from, int to) {
    std::vector<int> list(static_cast<std::size_t>(to - from + 1));
    std::iota(list.begin(), list.end(), from);
    return list;
  }

  const support::Folder folder_;
  std::unique_ptr<recording::FileSource> file_;
  std::unique_ptr<MessageSource> source_;
  std::unique_ptr<Player> sut_;
  std::vector<int> released_;
  std::vector<std::int64_t> at_ns_, due_ns_;
};

TEST_F(PlayerTest, EveryMessageIsReleasedOnceInOrderWithItsContent) {
  Player& sut = player();
  sut.begin(false);
  play_to_the_end();
  EXPECT_EQ(released_, numbers(0, kCount - 1));
  EXPECT_EQ(sut.released(), static_cast<std::uint64_t>(kCount));
  EXPECT_EQ(sut.errors().count(), static_cast<std::uint64_t>(kCount));
  EXPECT_EQ(sut.position_ns(), kEnd);
}

// Message n is due n ms * 1000 / rate after the clock's start, which begin() sets: not before
// `begun`.
TEST_F(PlayerTest, NoMessageIsReleasedBeforeItsTimeAtAnyRate) {
  for (const std::int64_t per_mille : {500, 1000, 2000, 100'000}) {
    released_.clear();
    at_ns_.clear();
    Player& sut = player(per_mille);
    const std::int64_t begun_ns = monotonic_ns();
    sut.begin(false);
    play_to_the_end();
    ASSERT_EQ(released_.size(), static_cast<std::size_t>(kCount));
    for (std::size_t n = 0; n < released_.size(); ++n) {
      ASSERT_GE(at_ns_[n] - begun_ns, static_cast<std::int64_t>(n) * kMs * 1000 / per_mille)
          << "message " << n << " at rate " << per_mille;
    }
  }
}

TEST_F(PlayerTest, OnlyMessagesFromTheFirstToTheLastInstantAreReleased) {
  player(100'000, false, kStart + 10 * kMs, kStart + 12 * kMs).begin(false);
  play_to_the_end();
  EXPECT_THAT(released_, ElementsAre(10, 11, 12));
}

TEST_F(PlayerTest, ARecordingWithoutAWantedMessageIsOverAtOnce) {
  Player& sut = player(1000, false, kStart, kEnd, {});
  sut.begin(false);
  EXPECT_FALSE(sut.step().has_value());
  EXPECT_EQ(sut.released(), 0u);
}

TEST_F(PlayerTest, TheStateFromBeforeTheFirstInstantComesFirst) {
  player(100'000, false, kStart + 30 * kMs + 1, kStart + 32 * kMs, {0}, {0}).begin(false);
  play_to_the_end();
  EXPECT_THAT(released_, ElementsAre(30, 31, 32));
  EXPECT_EQ(due_ns_.front(), kStart + 30 * kMs + 1);
}

// The caller asks the keyboard meanwhile, so a far message must not make it wait for long.
TEST_F(PlayerTest, AFarMessageLetsTheCallerWaitForTwentyMillisecondsAtMost) {
  Player& sut = player(100, false, kStart - 1000 * kMs, kEnd);  // 10 s until the first message
  sut.begin(false);
  EXPECT_TRUE(eventually([&] { return sut.step() == 20 * kMs; }));
  EXPECT_THAT(released_, IsEmpty());
  sut.set_paused(true);
  EXPECT_EQ(sut.step(), 20 * kMs);
}

TEST_F(PlayerTest, PausedItReleasesNothingButSingleSteps) {
  Player& sut = player(100'000);
  sut.begin(true);
  EXPECT_TRUE(sut.paused());
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(sut.step().has_value());
  EXPECT_THAT(released_, IsEmpty());
  EXPECT_EQ(sut.position_ns(), kStart);
  sut.step_once();
  sut.step_once();
  EXPECT_THAT(released_, ElementsAre(0, 1));
  EXPECT_EQ(sut.position_ns(), kStart + kMs);
  sut.set_paused(false);
  sut.step_once();  // without effect while it plays
  EXPECT_EQ(released_.size(), 2u);
  play_to_the_end();
  EXPECT_EQ(released_, numbers(0, kCount - 1));
}

TEST_F(PlayerTest, ASingleStepBehindTheLastMessageReleasesNothing) {
  Player& sut = player(1000);
  sut.begin(true);
  for (int i = 0; i < kCount + 3; ++i) sut.step_once();
  EXPECT_EQ(released_, numbers(0, kCount - 1));
  EXPECT_EQ(sut.position_ns(), kEnd);
}

TEST_F(PlayerTest, ASeekIsKeptInsideTheRecording) {
  Player& sut = player(1000);
  sut.begin(true);
  sut.seek(kEnd + 1);
  EXPECT_EQ(sut.position_ns(), kEnd);
  sut.step_once();
  sut.seek(-5);
  EXPECT_EQ(sut.position_ns(), kStart);
  sut.step_once();
  sut.seek(kStart + 20 * kMs + 1);
  EXPECT_TRUE(sut.paused());
  sut.step_once();
  EXPECT_THAT(released_, ElementsAre(kCount - 1, 0, 21));
}

TEST_F(PlayerTest, ANewRateKeepsThePositionAndThePause) {
  Player& sut = player(1000);
  sut.begin(true);
  sut.seek(kStart + 7 * kMs);
  sut.set_rate({50'000});
  EXPECT_EQ(sut.rate().per_mille, 50'000);
  EXPECT_EQ(sut.position_ns(), kStart + 7 * kMs);
  EXPECT_TRUE(sut.paused());
}

TEST_F(PlayerTest, ALoopedReplayBeginsAgainAtTheFirstInstant) {
  Player& sut = player(100'000, true, kStart + 38 * kMs, kEnd);
  EXPECT_TRUE(sut.looping());
  sut.begin(false);
  play(7);
  released_.resize(7);
  EXPECT_THAT(released_, ElementsAre(38, 39, 40, 38, 39, 40, 38));
}

TEST_F(PlayerTest, ALoopBetweenTwoInstantsReleasesNothingOutsideUntilItIsOff) {
  Player& sut = player(100'000);
  sut.begin(false);
  sut.loop_between(kStart + 5 * kMs, kStart + 7 * kMs);
  EXPECT_TRUE(sut.looping());
  play(20);
  for (std::size_t n = 0; n < released_.size(); ++n) {
    ASSERT_EQ(released_[n], 5 + static_cast<int>(n % 3)) << n;
  }
  sut.loop_off();
  EXPECT_FALSE(sut.looping());
  play_to_the_end();
  EXPECT_EQ(released_.back(), kCount - 1);
}

// Nothing steps, as when the machine holds the replay up: the clock runs on, the position does not.
TEST_F(PlayerTest, AReplayThatIsHeldUpIsNotBehindTheEndOfItsLoop) {
  Player& sut = player(1000);
  sut.begin(false);
  sut.loop_between(kStart + 5 * kMs, kStart + 7 * kMs);
  const std::int64_t begun_ns = monotonic_ns();
  ASSERT_TRUE(eventually([&] { return monotonic_ns() > begun_ns + 10 * kMs; }));
  EXPECT_EQ(sut.position_ns(), kStart + 7 * kMs);
}

TEST_F(PlayerTest, ALoopIsSetByItsStartAndThenItsEnd) {
  Player& sut = player(1000);
  sut.begin(true);
  sut.seek(kStart + 10 * kMs);
  sut.loop_from_here();
  EXPECT_FALSE(sut.looping());
  sut.loop_to_here();  // the same instant: no loop
  EXPECT_FALSE(sut.looping());
  sut.seek(kStart + 9 * kMs);
  sut.loop_to_here();  // before the start: no loop
  EXPECT_FALSE(sut.looping());
  sut.seek(kStart + 12 * kMs);
  sut.loop_to_here();
  EXPECT_TRUE(sut.looping());
  EXPECT_EQ(sut.position_ns(), kStart + 10 * kMs);
}

// Nothing steps for 40 ms, so every message is overdue.  Released at most twice as fast, the last
// one follows the first after half of their distance or more, so it is still 20 ms late: the
// machine held the replay up once.
TEST_F(PlayerTest, OverdueMessagesComeAtMostTwiceAsFastAndCountAsOneDelay) {
  Player& sut = player(1000);
  sut.begin(false);
  ASSERT_TRUE(eventually([&] { return sut.position_ns() == kEnd; }));
  const std::int64_t before_ns = monotonic_ns();
  play_to_the_end();
  ASSERT_EQ(released_.size(), static_cast<std::size_t>(kCount));
  EXPECT_GE(at_ns_.back() - before_ns, (kEnd - kStart) / 2);
  EXPECT_EQ(sut.held_up(), 1u);
  EXPECT_GE(sut.errors().max_us(), 40'000);
}

// A jump makes the lateness of before meaningless: the message is due at the jump.
TEST_F(PlayerTest, AfterASeekTheMessagesAreNotLate) {
  Player& sut = player(100'000);
  const std::int64_t begun_ns = monotonic_ns();
  sut.begin(false);
  ASSERT_TRUE(eventually([&] { return monotonic_ns() > begun_ns + 30 * kMs; }));
  const std::int64_t before_ns = monotonic_ns();
  sut.seek(kEnd);
  play(1);
  EXPECT_THAT(released_, ElementsAre(kCount - 1));
  EXPECT_LE(sut.errors().max_us(), (at_ns_.back() - before_ns) / 1000);
}

}  // namespace
}  // namespace stillhand::replay::player_test
