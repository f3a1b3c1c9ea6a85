// SPDX-License-Identifier: Apache-2.0
#include "services/bus/discovered_qos.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace stillhand::runtime::discovered_qos_test {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// What discovery would announce of a writer that offers this.
WriterQos announced(const WriterQos& wanted) {
  return discovered_qos(offered_qos(wanted).get_writerqos({}, {}));
}

// A replay offers what was recorded, to the nanosecond.
TEST(OfferedQosTest, DiscoveryAnnouncesWhatWasWanted) {
  std::mt19937_64 random(20261123);
  const auto duration_ns = [&] {
    if (random() % 4 == 0) return kForever_ns;
    return std::uniform_int_distribution<std::int64_t>(1, 1000 * kSecond_ns)(random);
  };
  for (int turn = 0; turn < 500; ++turn) {
    WriterQos wanted;
    wanted.reliable = random() % 2 == 0;
    wanted.durability = static_cast<Durability>(random() % 2);
    wanted.liveliness = static_cast<Liveliness>(random() % 3);
    wanted.exclusive = random() % 2 == 0;
    wanted.deadline_ns = duration_ns();
    wanted.lifespan_ns = duration_ns();
    wanted.lease_ns = duration_ns();
    ASSERT_EQ(announced(wanted), wanted) << "turn " << turn;
  }
}

TEST(OfferedQosTest, WhatWasKeptOnADiskIsOfferedFromMemory) {
  for (const auto durability : {Durability::kTransient, Durability::kPersistent}) {
    const WriterQos wanted{.durability = durability};
    EXPECT_EQ(announced(wanted).durability, Durability::kTransientLocal);
  }
}

// The seconds of a DDS duration have 32 bits, and a recording's nanoseconds 64.
TEST(OfferedQosTest, ADurationThatDdsCannotHoldIsForever) {
  for (const std::int64_t ns :
       {kForever_ns - 1, kForever_ns / 2, std::int64_t{INT32_MAX} * kSecond_ns}) {
    WriterQos wanted;
    wanted.deadline_ns = wanted.lifespan_ns = wanted.lease_ns = ns;
    const WriterQos offered = announced(wanted);
    EXPECT_EQ(offered.deadline_ns, kForever_ns) << ns;
    EXPECT_EQ(offered.lifespan_ns, kForever_ns) << ns;
    EXPECT_EQ(offered.lease_ns, kForever_ns) << ns;
  }
  const WriterQos longest{.deadline_ns = std::int64_t{INT32_MAX} * kSecond_ns - 1};
  EXPECT_EQ(announced(longest).deadline_ns, longest.deadline_ns);
}

// DDS demands an announcement period shorter than the lease.
TEST(OfferedQosTest, AWriterAnnouncesItselfThreeTimesALease) {
  for (const std::int64_t lease_ns :
       {std::int64_t{10}, std::int64_t{5'000'000}, 3600 * kSecond_ns}) {
    const WriterQos wanted{.lease_ns = lease_ns};
    const auto period = offered_qos(wanted).liveliness().announcement_period;
    const std::int64_t period_ns = period.seconds * kSecond_ns + period.nanosec;
    EXPECT_EQ(period_ns, lease_ns * 3 / 10);
  }
}

TEST(OfferedQosTest, TheDepthIsThatOfTheRecording) {
  WriterQos wanted{.depth = 7};
  const auto kept = offered_qos(wanted);
  EXPECT_EQ(kept.history().kind, edds::KEEP_LAST_HISTORY_QOS);
  EXPECT_EQ(kept.history().depth, 7);
  wanted.depth = -1;
  EXPECT_EQ(offered_qos(wanted).history().kind, edds::KEEP_ALL_HISTORY_QOS);
  wanted.depth = 0;
  const auto unknown = offered_qos(wanted);
  EXPECT_EQ(unknown.history().kind, edds::KEEP_LAST_HISTORY_QOS);
  EXPECT_GT(unknown.history().depth, 16);  // a burst at 1 kHz
}

// DDS refuses a writer whose limits contradict one another: max_samples >= those of one instance,
// and depth <= those of one instance.
TEST(OfferedQosTest, TheLimitsHoldTheDepthOfEveryInstance) {
  for (const std::int32_t depth : {0, 1, 16, 33'554'431, 33'554'432, INT32_MAX}) {
    const WriterQos wanted{.depth = depth};
    const auto qos = offered_qos(wanted);
    const auto& limits = qos.resource_limits();
    EXPECT_GE(limits.max_samples_per_instance, qos.history().depth) << depth;
    if (limits.max_samples == edds::LENGTH_UNLIMITED) continue;
    EXPECT_EQ(std::int64_t{limits.max_samples},
              std::int64_t{limits.max_samples_per_instance} * limits.max_instances)
        << depth;
  }
}

}  // namespace
}  // namespace stillhand::runtime::discovered_qos_test
