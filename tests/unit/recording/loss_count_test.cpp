// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/loss_count.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stillhand::recording::loss_count_test {
namespace {

TEST(LossCountTest, ASampleIsLostWhereEitherNumberIsMissing) {
  const struct {
    const char* what;
    std::vector<std::pair<std::int64_t, Tick>> samples;
    std::int64_t lost, not_sent;
  } cases[] = {
      {"both go on", {{40, 7}, {41, 8}, {42, 9}}, 0, 0},
      {"sent before the first sample", {{1'000'000, 5'000'000}}, 0, 0},
      {"missing by both counts once", {{1, 10}, {4, 13}}, 2, 0},
      {"a tick never reached the writer's DDS", {{1, 10}, {2, 14}}, 3, 3},
      {"without ticks the sequence shows it", {{1, -1}, {6, -1}}, 4, 0},
      {"another session of the writer", {{1, 9000}, {2, 0}, {3, 1}}, 0, 0},
  };
  for (const auto& [what, samples, lost, not_sent] : cases) {
    LossCount sut;
    for (const auto& [sequence, tick] : samples) sut.step(sequence, tick);
    EXPECT_EQ(sut.received(), static_cast<std::int64_t>(samples.size())) << what;
    EXPECT_EQ(sut.lost(), lost) << what;
    EXPECT_EQ(sut.not_sent(), not_sent) << what;
  }
}

TEST(LossCountTest, TheEndOfAnInstanceIsNoLossAndHidesNone) {
  LossCount sut;
  sut.step(1, -1);
  sut.end_instance(2);
  sut.end_instance(3);
  sut.step(4, -1);
  EXPECT_EQ(sut.received(), 2);
  EXPECT_EQ(sut.lost(), 0);
  sut.end_instance(7);
  sut.step(8, -1);
  EXPECT_EQ(sut.lost(), 2);
}

// The writer drops ticks before DDS, the network drops sequence numbers: the count of each is
// known.
TEST(LossCountTest, OverRandomLossesTheCountsAreThoseThatWereMade) {
  std::mt19937_64 random(21);
  for (int round = 0; round < 200; ++round) {
    const auto network = random() % 4, writer = random() % 4;
    LossCount sut;
    std::int64_t sequence = static_cast<std::int64_t>(random() % 1000), received = 0, lost = 0,
                 not_sent = 0;
    std::int64_t lost_since = 0, not_sent_since = 0;  // losses at the end are not known yet
    for (Tick tick = 0; tick < 500; ++tick) {
      const bool reaches_dds = random() % 8 >= writer;
      if (!reaches_dds) {
        ++not_sent_since;
        continue;
      }
      ++sequence;
      if (random() % 8 < network) {
        ++lost_since;
        continue;
      }
      sut.step(sequence, tick);
      if (++received > 1) {
        lost += lost_since + not_sent_since;
        not_sent += not_sent_since;
      }
      lost_since = not_sent_since = 0;
    }
    ASSERT_EQ(sut.received(), received);
    ASSERT_EQ(sut.lost(), lost) << round;
    ASSERT_EQ(sut.not_sent(), not_sent) << round;
  }
}

}  // namespace
}  // namespace stillhand::recording::loss_count_test
