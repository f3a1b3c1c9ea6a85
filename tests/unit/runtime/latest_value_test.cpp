// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/latest_value.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace stillhand::runtime::latest_value_test {
namespace {

struct Pair {
  std::int64_t first = 0;
  std::int64_t second = 0;
};

TEST(LatestValueTest, GivesTheDefaultBeforeTheFirstStore) {
  LatestValue<Pair> sut;
  EXPECT_EQ(sut.load().first, 0);
}

TEST(LatestValueTest, GivesTheNewestAndKeepsIt) {
  LatestValue<Pair> sut;
  sut.store({1, 1});
  sut.store({2, 2});
  EXPECT_EQ(sut.load().first, 2);
  EXPECT_EQ(sut.load().first, 2);
  sut.store({3, 3});
  EXPECT_EQ(sut.load().first, 3);
}

TEST(LatestValueTest, IsNeverTornNorGoesBack) {
  LatestValue<Pair> sut;
  constexpr std::int64_t kCount = 1'000'000;
  std::thread writer([&] {
    for (std::int64_t i = 1; i <= kCount; ++i) sut.store({i, -i});
  });
  std::int64_t last = 0;
  while (last < kCount) {
    const Pair value = sut.load();
    ASSERT_EQ(value.first, -value.second);
    ASSERT_GE(value.first, last);
    last = value.first;
  }
  writer.join();
}

}  // namespace
}  // namespace stillhand::runtime::latest_value_test
