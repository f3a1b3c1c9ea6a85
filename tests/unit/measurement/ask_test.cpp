// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/ask.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "apps/libraries/measurement/tables/text_table.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement::ask_test {

using testing::HasSubstr;

struct Dialogue {
  std::vector<std::string> wishes;
  std::optional<double> rate_hz;
  std::string shown;
};

Dialogue ask(const std::string& text, const std::string& answers) {
  const auto file = text_table({text, {}}, "ride.csv", {}, 1000);
  std::istringstream in(answers);
  std::ostringstream out;
  const Mapping mapping = ask_mapping(*file, in, out);
  Dialogue sut{{}, mapping.rate_hz, out.str()};
  for (const ColumnWish& wish : mapping.columns) sut.wishes.push_back(wish_text(wish));
  return sut;
}

constexpr const char* kRide = "time,acc,force,angle\n0,1,2,3\n0.01,1,2,3\n";

TEST(AskTest, EnterTakesWhatIsProposed) {
  const Dialogue sut = ask(kRide, "\n\n\n\n");
  EXPECT_THAT(sut.wishes, testing::ElementsAre("time=t [s]", "acc=a_y [m/s^2]", "force=f [N]"));
  EXPECT_THAT(sut.shown, HasSubstr("#4   angle"));
  EXPECT_THAT(sut.shown, HasSubstr("t, time (time [s]): "));
}

TEST(AskTest, AnswersCountAndWrongOnesAreAskedAgain) {
  const Dialogue sut =
      ask(kRide, "speed\ntime [ms\n#1 [ms]\n-\nforce [kN] * 2\nangle\ntheta=angle [deg]\n\n");
  EXPECT_THAT(sut.wishes,
              testing::ElementsAre("time=t [ms]", "force=f [kN] * 2", "angle=theta [deg]"));
  EXPECT_THAT(sut.shown, HasSubstr("there is no column 'speed'"));
  EXPECT_THAT(sut.shown, HasSubstr("NAME=COLUMN [UNIT], for example"));
}

TEST(AskTest, WithoutATimeTheSampleRateIsAskedFor) {
  const Dialogue sut = ask("p,q\n1,2\n1,2\n", "-\n#1 [g]\n#2 [N]\n\nfast\n500\n");
  EXPECT_THAT(sut.wishes, testing::ElementsAre("p=a_y [g]", "q=f [N]"));
  EXPECT_EQ(sut.rate_hz, 500.0);
}

TEST(AskTest, ATitleIsNotTheBeginningOfAnother) {
  const Dialogue sut = ask("a,b\n1,2\n1,2\n", "-\n#12\nacc\n#1 [g]\nb[N]\n\ninf\n1e300\n500\n");
  EXPECT_THAT(sut.wishes, testing::ElementsAre("a=a_y [g]", "b=f [N]"));
  EXPECT_THAT(sut.shown, HasSubstr("there is no column '#12'"));
  EXPECT_THAT(sut.shown, HasSubstr("there is no column 'acc'"));
  EXPECT_EQ(sut.rate_hz, 500.0);
}

TEST(AskTest, AnswersThatEndEarlyAreRefused) { EXPECT_THROW(ask(kRide, "\n\n"), ConfigError); }

}  // namespace stillhand::measurement::ask_test
