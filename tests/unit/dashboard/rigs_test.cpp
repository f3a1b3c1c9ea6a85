// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/rigs.hpp"

#include <gtest/gtest.h>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/topics.hpp"

namespace stillhand::dashboard::rigs_test {

constexpr std::int64_t kPeriod_ns = 1'000'000;

std::vector<std::byte> sample(std::uint32_t rig, Tick tick) {
  stillhand_msgs::RawSample message;
  message.rig(rig);
  message.tick(tick);
  message.stamp_ns(tick * kPeriod_ns);
  return to_cdr(message);
}

class RigsTest : public ::testing::Test {
 protected:
  static FeedOptions shown(std::uint32_t rig) {
    FeedOptions options;
    options.rig = rig;
    return options;
  }
  void add(std::uint32_t rig) {
    sut_.add({std::string(topics::kRawSample.name), std::string(topics::kRawSample.type),
              "stillhand/" + std::to_string(rig) + "/rig", false});
  }
  void write(std::uint32_t writer, std::uint32_t rig, Tick tick) {
    const std::vector<std::byte> bytes = sample(rig, tick);
    const std::int64_t at_ns = tick * kPeriod_ns + 1;
    sut_.take({writer, static_cast<std::uint32_t>(tick + 1), at_ns, at_ns, bytes});
  }

  Rigs sut_{shown(2)};
};

TEST_F(RigsTest, EachRigIsCountedForItself) {
  add(2);
  for (Tick tick = 0; tick < 10; ++tick) write(0, 2, tick);
  add(5);
  for (Tick tick = 0; tick < 30; tick += 3) write(1, 5, tick);
  const auto all = sut_.summaries();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].rig, 2u);
  EXPECT_EQ(all[0].samples, 10u);
  EXPECT_EQ(all[0].lost, 0u);
  EXPECT_EQ(all[1].rig, 5u);
  EXPECT_EQ(all[1].samples, 10u);
  EXPECT_EQ(all[1].lost, 18u);
  EXPECT_EQ(sut_.shown().newest_tick(), 9);
}

TEST_F(RigsTest, TheOneThatIsShownIsThereBeforeItIsHeard) {
  const auto all = sut_.summaries();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].rig, 2u);
  EXPECT_EQ(all[0].samples, 0u);
}

TEST_F(RigsTest, WhoBringsMoreRigsThanThereMayBeIsNotCounted) {
  add(1);
  for (std::uint32_t rig = 10; rig < 10 + 2 * Rigs::kMostRigs; ++rig) write(0, rig, 0);
  EXPECT_EQ(sut_.summaries().size(), Rigs::kMostRigs);
  write(0, 0, 0);  // no rig's
  EXPECT_EQ(sut_.shown().newest_tick(), -1);
}

}  // namespace stillhand::dashboard::rigs_test
