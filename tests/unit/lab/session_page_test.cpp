// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/session_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::lab {
namespace {

using session::Condition;

using testing::HasSubstr;
using testing::Not;

session::TrialResult trial(Condition label, double rms_error_mm) {
  session::TrialResult result{};
  result.label = label;
  result.metrics.rms_error_mm = rms_error_mm;
  return result;
}

TEST(SessionPageTest, TheSessionsFiguresStandNextToThePapers) {
  session::SessionResult result;
  result.trials = {trial(Condition::kA, 20.0), trial(Condition::kB, 50.0),
                   trial(Condition::kC, 35.0)};
  const std::string sut = session_page(result, {}).html();
  for (const char* figure : {"20.00", "50.00", "35.00", "50 %", "4.04", "9.62", "7.01", "47 %"}) {
    EXPECT_THAT(sut, HasSubstr(figure));
  }
  EXPECT_THAT(sut, Not(HasSubstr("Traces")));
}

TEST(SessionPageTest, AConditionThatDidNotRunHasNoFigure) {
  session::SessionResult result;
  result.trials = {trial(Condition::kA, 20.0)};
  const std::string sut = session_page(result, {}).html();
  EXPECT_THAT(sut, HasSubstr("20.00"));
  EXPECT_THAT(sut, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace stillhand::lab
