// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/remark.hpp"

#include <gtest/gtest.h>

namespace stillhand::runtime::remark_test {
namespace {

using namespace std::string_literals;

TEST(RemarkTest, TheVerbThatWasTypedIsThePrefix) {
  EXPECT_EQ(prefix_of("/opt/bin/stillhand\0lab\0--seed\0001\0"s), "stillhand lab");
  EXPECT_EQ(prefix_of("bin/stillhand\0experiment\0run\0study1\0"s), "stillhand experiment");
  EXPECT_EQ(prefix_of("stillhand\0stop\0"s), "stillhand stop");
}

TEST(RemarkTest, WithoutAVerbTheProgramAloneIsThePrefix) {
  EXPECT_EQ(prefix_of("stillhand\0"s), "stillhand");
  EXPECT_EQ(prefix_of("stillhand\0--version\0"s), "stillhand");
  EXPECT_EQ(prefix_of("stillhand"), "stillhand");
  EXPECT_EQ(prefix_of(""), "stillhand");
}

}  // namespace
}  // namespace stillhand::runtime::remark_test
