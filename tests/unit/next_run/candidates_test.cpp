// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "services/core/next_run/tie.hpp"
#include "tests/unit/next_run/two_channels.hpp"

namespace stillhand::next_run::candidates_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A body on a ride, and a force of x; z is x and a hundredth of its own.
diagnosis::Measurement measured() {
  constexpr std::size_t kCount = 5000;
  const auto u = diagnosis::made::ride(kCount, 1);
  const auto x = diagnosis::made::ride(kCount, 2, 0.2, 2.0);
  std::vector<double> z = diagnosis::made::white(kCount, 3);
  std::vector<double> y = diagnosis::made::white(kCount, 4);
  for (std::size_t n = 0; n < kCount; ++n) {
    z[n] = x[n] + 0.01 * z[n];
    y[n] = 2.0 * u[n] + x[n] + 0.5 * y[n];
  }
  return diagnosis::made::measurement_of(
      {{"u", "m/s^2", u}, {"x", "-", x}, {"z", "-", z}, {"y", "N", y}});
}

TEST(CandidatesTest, TwoChannelsThatAreNearlyTheSameAreTied) {
  const auto recording = measured();
  diagnosis::DiagnoseOptions options;
  options.inputs = {"u"};
  options.output = "y";
  const diagnosis::Signals signals(recording, {"u"}, "y");
  const auto sut = ties_of(diagnosis::diagnose(recording, options), signals);
  ASSERT_FALSE(sut.empty());
  std::vector<std::string> channels;
  for (const Candidate& each : sut.front().close) {
    if (each.cause().kind == "coupled_input") channels.push_back(each.cause().channels.front());
  }
  EXPECT_THAT(channels, testing::IsSupersetOf({"x", "z"}));
}

const diagnosis::Effect kStatic{"coupled_input", "static", {"x"}, {}, {1.0}};
const diagnosis::Effect kSlopes{"asymmetry", "slopes of the output", {}, {}, {0.01, 0.01}};

diagnosis::Trial tried(const diagnosis::Effect& effect, std::size_t order) {
  diagnosis::Body body;
  body.denominator.assign(order + 1, 0.0);
  body.denominator.front() = 1.0;
  body.numerators = {std::vector<double>(order + 1, 1.0)};
  diagnosis::Trial trial;
  trial.rmse = 1.0;
  trial.model = diagnosis::made::model_of(body, {effect});
  return trial;
}

// The verdict is the first of them, and `found` behind it.
std::vector<Candidate> candidates_among(const std::vector<diagnosis::Trial>& trials,
                                        const diagnosis::Effect& found) {
  diagnosis::Diagnosis diagnosis;
  diagnosis::Addition addition;
  addition.tried = trials;
  diagnosis.search.additions = {addition};
  diagnosis.effects.resize(1);
  for (const auto& trial : trials) {
    diagnosis.effects.front().ties.push_back(trial.model.effects.front().kind);
  }
  diagnosis.model = trials.front().model;
  diagnosis.model.effects.push_back(found);
  return candidates_of(diagnosis, 0, diagnosis::Signals(measured(), {"u"}, "y"));
}

// The rival was tried with a body of its own, and takes over the spring that was found behind it.
TEST(CandidatesTest, ARivalMayHaveABodyOfAnotherOrder) {
  diagnosis::Effect of_z = kStatic;
  of_z.channels = {"z"};
  const auto sut = candidates_among({tried(kStatic, 2), tried(of_z, 1)}, kSlopes);
  ASSERT_EQ(sut.size(), 2U);
  for (const Candidate& each : sut) {
    EXPECT_EQ(each.model.effects.back().coefficients.size(), each.model.body.order());
    EXPECT_EQ(each.cause().kind, "coupled_input");
  }
}

TEST(CandidatesTest, ARivalInsideOfTheBodyTakesOverNoOtherOne) {
  const diagnosis::Effect rival{"hysteresis",
                                "elastic-plastic of the output",
                                {},
                                {{"threshold", "N", 1.0, 0.1, 10.0}},
                                {0.01, 0.01}};
  const auto sut = candidates_among({tried(kStatic, 2), tried(rival, 2)}, kSlopes);
  ASSERT_EQ(sut.size(), 2U);
  EXPECT_EQ(sut[0].model.effects.size(), 2U);
  ASSERT_EQ(sut[1].model.effects.size(), 1U);
  EXPECT_EQ(sut[1].cause().kind, "hysteresis");
}

TEST(CandidatesTest, ATieHasOneWordingWhetherItIsBrokenOrNot) {
  Tie tie{0, {made::candidate("x"), made::candidate("z")}};
  tie.left = tie.close;
  EXPECT_FALSE(tie.broken());
  EXPECT_EQ(
      tie.in_words(),
      "tied on this recording: coupled_input (of x, static) and coupled_input (of z, static)");
  tie.left.pop_back();
  EXPECT_TRUE(tie.broken());
  EXPECT_EQ(tie.in_words(),
            "of 2 causes that are close the whole recording leaves coupled_input (of x, static)");
}

TEST(CandidatesTest, AChannelThatOneReadsTellsThemApart) {
  auto recording = made::measured(1000, 8, 1);
  recording.channels[1].unit = "degC";
  recording.channels[2].unit = "N";
  const diagnosis::Signals signals(recording, {"u"}, "y");
  EXPECT_THAT(other_ways(made::candidate("x"), made::candidate("z"), signals),
              ElementsAre(AllOf(HasSubstr("x"), HasSubstr("cold and warm")),
                          AllOf(HasSubstr("z"), HasSubstr("firm hold"))));
  EXPECT_THAT(other_ways(made::candidate("x"), made::candidate("x"), signals), IsEmpty());
  EXPECT_THAT(other_ways(made::candidate("x"), made::candidate("u"), signals),
              ElementsAre(HasSubstr("x")));
}

TEST(CandidatesTest, AMassInPlaceOfTheHandTellsTheChainFromTheBody) {
  const diagnosis::Signals signals(made::measured(1000, 8, 1), {"u"}, "y");
  Candidate late = made::candidate("u");
  late.model.effects[0] = {"delay", "fixed", {}, {}, {}};
  EXPECT_THAT(other_ways(made::candidate("u"), late, signals), ElementsAre(HasSubstr("a mass")));
  EXPECT_THAT(other_ways(late, late, signals), IsEmpty());
}

TEST(CandidatesTest, ARollIsTiltedAndAStickMoved) {
  auto recording = made::measured(1000, 8, 1);
  recording.channels[1].name = "roll";
  recording.channels[2].name = "theta";
  const diagnosis::Signals signals(recording, {"u"}, "y");
  EXPECT_THAT(other_ways(made::candidate("roll"), made::candidate("theta"), signals),
              ElementsAre(HasSubstr("tilt the platform"), HasSubstr("with the stick free")));
}

TEST(CandidatesTest, WhatGoesWithTimeNeedNotComeAgain) {
  auto recording = made::measured(1000, 8, 1);
  recording.channels[1].unit = "m/s^2";
  const diagnosis::Signals signals(recording, {"u"}, "y");
  Candidate drift = made::candidate("x");
  drift.model.effects[0] = {"drift", "linear", {}, {}, {1.0}};
  EXPECT_EQ(name_of(drift), "drift (linear)");
  EXPECT_THAT(other_ways(drift, made::candidate("x"), signals),
              ElementsAre(HasSubstr("after a pause: drift goes"), HasSubstr("move x too")));
  EXPECT_THAT(other_ways(made::candidate("z"), drift, signals),
              ElementsAre("move z on its own", HasSubstr("after a pause")));
}

// A rival that takes part must have been finite; of one cause, the form that stands first.
TEST(CandidatesTest, OfOneCauseOneFormIsARival) {
  diagnosis::Effect other_form = kStatic;
  other_form.form = "lagged";
  other_form.parameters = {{"lag", "s", 0.1, 0.01, 1.0}};
  EXPECT_THAT(candidates_among({tried(kStatic, 2), tried(other_form, 2)}, kSlopes), IsEmpty());
  diagnosis::Effect of_z = kStatic;
  of_z.channels = {"z"};
  diagnosis::Trial ran_away = tried(of_z, 2);
  ran_away.rmse = HUGE_VAL;
  EXPECT_THAT(candidates_among({tried(kStatic, 2), ran_away}, kSlopes), IsEmpty());
}

}  // namespace stillhand::next_run::candidates_test
