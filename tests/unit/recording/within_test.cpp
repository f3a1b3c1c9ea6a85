// SPDX-License-Identifier: Apache-2.0
#include "services/files/recording/within.hpp"

#include <gtest/gtest.h>

namespace stillhand::recording {
namespace {

TEST(WithinTest, NumbersBetweenTheBoundsPassAndNothingElseDoes) {
  const CLI::Validator sut = within(0.5, 1e7);
  for (const char* good : {"0.5", "1", "1e7", "9999999.5"}) {
    EXPECT_EQ(sut(std::string(good)), "") << good;
  }
  for (const char* bad :
       {"0.49", "1.1e7", "nan", "-nan", "NAN", "inf", "-inf", "1e999", "-1", "", "one", "1 2"}) {
    EXPECT_EQ(sut(std::string(bad)), "got " + std::string(bad) + ", want 0.5 to 1e+07") << bad;
  }
}

}  // namespace
}  // namespace stillhand::recording
