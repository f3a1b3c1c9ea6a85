// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/check_number.hpp"

#include <gmock/gmock.h>

namespace stillhand::settings::check_number_test {

TEST(NumberBetweenTest, TakesBothEndsAndWhatLiesBetween) {
  const auto sut = number_between(-1.5, 49.0);
  for (const char* word : {"-1.5", "49", "49.0", "0", "-0", "1e1", "48.999999999999"}) {
    EXPECT_EQ(sut(word), "") << word;
  }
}

TEST(NumberBetweenTest, RefusesWhatIsOutsideOrNoNumberAndSaysWhatIsWanted) {
  const auto sut = number_between(0.0, 49.0);
  for (const char* word : {"-0.001", "49.001", "nan", "-nan", "inf", "-inf", "1e400", "", " 1",
                           "1 ", "1,5", "0x10", "1.5N", "--"}) {
    EXPECT_THAT(sut(word), testing::HasSubstr("want a number from 0 to 49")) << word;
  }
}

}  // namespace stillhand::settings::check_number_test
