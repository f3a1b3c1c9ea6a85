// SPDX-License-Identifier: Apache-2.0
#include "services/core/contract/flag.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <initializer_list>

namespace stillhand::flag_test {
namespace {

// Recordings hold the bits, so each keeps its own for good.
TEST(FlagTest, EveryReasonHasABitOfItsOwn) {
  Flags seen = kGood;
  for (const Flag flag : {kInputGap, kSaturated, kSlewLimited, kInputStale, kInputInvalid,
                          kInhibited, kWorkspaceLimit, kNoModel, kRampingDown, kAtStop, kFault}) {
    EXPECT_TRUE(std::has_single_bit(static_cast<Flags>(flag))) << flag;
    EXPECT_EQ(seen & flag, kGood) << flag;
    seen |= flag;
  }
  EXPECT_EQ(seen, 0x800003FFu);
}

}  // namespace
}  // namespace stillhand::flag_test
