// SPDX-License-Identifier: Apache-2.0
#include "services/bus/replay_mark.hpp"

#include <gtest/gtest.h>

namespace stillhand::runtime::replay_mark_test {
namespace {

TEST(ReplayMarkTest, IsRecognisedAloneAndBeforeOtherUserData) {
  std::vector<std::uint8_t> mark = replay_mark();
  EXPECT_TRUE(is_replay_mark(mark));
  mark.push_back(0);
  mark.push_back(0xff);
  EXPECT_TRUE(is_replay_mark(mark));
}

// What is not recognised could move the stick: so every byte counts.
TEST(ReplayMarkTest, IsNotRecognisedWithAByteMissingOrChanged) {
  EXPECT_FALSE(is_replay_mark({}));
  const std::vector<std::uint8_t> mark = replay_mark();
  for (std::size_t i = 0; i < mark.size(); ++i) {
    std::vector<std::uint8_t> changed = mark;
    changed[i] ^= 0x20u;
    EXPECT_FALSE(is_replay_mark(changed)) << "byte " << i;
    EXPECT_FALSE(is_replay_mark({mark.begin(), mark.begin() + static_cast<std::ptrdiff_t>(i)}))
        << "length " << i;
  }
  std::vector<std::uint8_t> later = mark;
  later.insert(later.begin(), ' ');
  EXPECT_FALSE(is_replay_mark(later));
}

}  // namespace
}  // namespace stillhand::runtime::replay_mark_test
