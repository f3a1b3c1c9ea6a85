// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/rest.hpp"

#include "tests/unit/lab/stage_fixture.hpp"

namespace stillhand::lab::rest_test {
namespace {

class RestTest : public StageTest {
 protected:
  Rest sut_{"break", 10.0, trouble_};
};

TEST_F(RestTest, ItLastsItsTimeAndShowsWhatIsLeft) {
  EXPECT_EQ(step(sut_).progress->what, "break, 10 s left");
  EXPECT_EQ(step(sut_, 4 * kSecond).progress->what, "break, 6 s left");
  EXPECT_FALSE(sut_.over());
  step(sut_, 6 * kSecond);
  EXPECT_TRUE(sut_.over());
}

TEST_F(RestTest, ARequestForAStartEndsIt) {
  seen_.requests.take({Action::kStart, 1, "desk", ""}, false);  // before it: does not count
  step(sut_);
  EXPECT_FALSE(sut_.over());
  seen_.requests.take({Action::kStart, 2, "desk", ""}, false);
  step(sut_);
  EXPECT_TRUE(sut_.over());
}

TEST_F(RestTest, AnInterruptionEndsIt) {
  step(sut_);
  seen_.interrupted = true;
  step(sut_);
  EXPECT_TRUE(sut_.over());
}

TEST_F(RestTest, TheEndOfAProcessEndsIt) {
  step(sut_);
  end_of_process({"rig ended", false, false}, sut_);
  EXPECT_TRUE(sut_.over());
  EXPECT_EQ(trouble_.why(), "rig ended");
}

TEST_F(RestTest, WhatItWaitsForEndsIt) {
  bool is_there = false;
  Rest sut("diagnosis", 10.0, trouble_, [&] { return is_there; });
  step(sut);
  EXPECT_FALSE(sut.over());
  // A start cancels a pause, too: it must not throw away what is waited for.
  seen_.requests.take({Action::kStart, 1, "desk", ""}, false);
  step(sut);
  EXPECT_FALSE(sut.over());
  is_there = true;
  step(sut);
  EXPECT_TRUE(sut.over());
}

TEST_F(RestTest, WithoutATimeItIsOverAtOnce) {
  Rest sut("rest", 0.0, trouble_);
  step(sut);
  EXPECT_TRUE(sut.over());
}

}  // namespace
}  // namespace stillhand::lab::rest_test
