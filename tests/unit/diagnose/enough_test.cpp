// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/enough.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnose::enough_test {

namespace made = diagnosis::made;

std::vector<diagnosis::Measurement> recordings(std::vector<double> u) {
  std::vector<double> y = u;
  return {made::measurement_of({{"u", "m/s^2", std::move(u)}, {"y", "N", std::move(y)}})};
}

diagnosis::DiagnoseOptions options() {
  diagnosis::DiagnoseOptions made;
  made.inputs = {"u"};
  made.output = "y";
  return made;
}

std::vector<double> sine(std::size_t count, double period) {
  std::vector<double> u(count);
  for (std::size_t n = 0; n < count; ++n) {
    u[n] = std::sin(2.0 * std::numbers::pi * static_cast<double>(n) / period);
  }
  return u;
}

// 4 poles, 5 numerators, an offset: 10 numbers, ten samples each on four fifths.
TEST(EnoughTest, FastMotionIsAskedForTheNumbersOfTheModel) {
  EXPECT_EQ(fewest_samples(recordings(made::white(1000, 1)), options()), 125U);
  diagnosis::DiagnoseOptions two = options();
  two.inputs = {"u", "y"};
  EXPECT_EQ(fewest_samples(recordings(made::white(1000, 1)), two), 188U);
}

TEST(EnoughTest, SlowMotionIsAskedForTwoOfItsPeriods) {
  EXPECT_NEAR(static_cast<double>(fewest_samples(recordings(sine(4000, 400.0)), options())), 800.0,
              3.0);
}

TEST(EnoughTest, ARefusalSaysWhatWouldBeEnough) {
  EXPECT_THAT(
      support::refusal([] { check_enough(recordings(made::white(50, 1)), options()); }),
      testing::AllOf(testing::HasSubstr("got 50 samples, want 125 (1.25 s) or more: ten for each "
                                        "of the model's 10 numbers"),
                     testing::Not(testing::HasSubstr("\n"))));
  check_enough(recordings(made::white(125, 1)), options());
  // Several recordings of one rig count together.
  auto two = recordings(made::white(63, 1));
  two.push_back(two.front());
  check_enough(two, options());
}

}  // namespace stillhand::diagnose::enough_test
