// SPDX-License-Identifier: Apache-2.0
// Repeats of short trials: what they share, and that threads change nothing.
#include "apps/close_the_loop/session/repeats.hpp"

#include <gtest/gtest.h>

#include "apps/close_the_loop/verdict/control_model.hpp"

namespace stillhand::close_the_loop::repeats_test {
namespace {

session::ProtocolOptions short_protocol() {
  session::ProtocolOptions protocol;
  protocol.conditions = session::parse_conditions("A,B,C");
  protocol.identify_s = 5.0;
  protocol.trial_s = 10.0;
  return protocol;
}

// About what the body feeds through at rest, not followed and followed.
LoopResult looped(bool augmented) {
  LoopResult result;
  result.paper_model.control = {1000.0, {-3.2, 0.0}, {1.0, 0.0}};
  result.followed_model = cancellation::control_model(result.paper_model.control);
  result.followed_model.adapts = average_hand();
  Round round;
  round.augmented = augmented;
  round.model = cancellation::control_model({1000.0, {-2.5, 0.0}, {1.0, 0.0}});
  result.rounds = {round};
  return result;
}

Conditions run(const LoopResult& result, std::int64_t repeats, unsigned threads) {
  return run_repeats(result, short_protocol(), {}, {repeats, threads});
}

TEST(RepeatsTest, TheResultsDoNotDependOnTheThreads) {
  const LoopResult result = looped(true);
  const Conditions one = run(result, 3, 1);
  const Conditions four = run(result, 3, 4);
  for (const char* label : kConditions) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (const Number& measure : session::numbers(session::kLoop)) {
        const double first = measure.of(one.at(label)[r]);
        const double second = measure.of(four.at(label)[r]);
        EXPECT_TRUE(first == second || (std::isnan(first) && std::isnan(second)))
            << label << r << measure.key;
      }
    }
  }
}

TEST(RepeatsTest, EachRepeatHasDrawsOfItsOwn) {
  const Conditions sut = run(looped(true), 3, 2);
  for (const char* label : kConditions) {
    const auto& runs = sut.at(label);
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_NE(runs[0].metrics.rms_error_mm, runs[1].metrics.rms_error_mm) << label;
    EXPECT_NE(runs[1].metrics.rms_error_mm, runs[2].metrics.rms_error_mm) << label;
    EXPECT_EQ(runs[0].label, label);
  }
  // More repeats leave the first ones as they are.
  EXPECT_EQ(run(looped(true), 1, 1).at("C")[0].metrics.rms_error_mm,
            sut.at("C")[0].metrics.rms_error_mm);
}

TEST(RepeatsTest, TheMotorActsInTheCancellingConditionsAlone) {
  const Conditions sut = run(looped(true), 1, 1);
  EXPECT_EQ(sut.at("A")[0].forces.motor_n, 0.0);
  EXPECT_EQ(sut.at("B")[0].forces.motor_n, 0.0);
  for (const char* label : kCancelling) {
    EXPECT_GT(sut.at(label)[0].forces.motor_n, 1.0) << label;
    EXPECT_LT(sut.at(label)[0].forces.left_n, sut.at("B")[0].forces.left_n) << label;
  }
  EXPECT_LT(sut.at("A")[0].forces.left_n, 0.2 * sut.at("B")[0].forces.left_n);
}

// With one model for all, everything that a repeat draws is shared: the trials agree to the bit.
TEST(RepeatsTest, TheSameModelGivesTheSameTrial) {
  LoopResult result = looped(true);
  result.followed_model.adapts.reset();
  result.rounds[0].model = result.followed_model;
  const Conditions sut = run(result, 2, 2);
  for (std::size_t r = 0; r < 2; ++r) {
    for (const Number& measure : session::numbers(session::kLoop)) {
      if (std::isnan(measure.of(sut.at("C")[r]))) continue;
      EXPECT_EQ(measure.of(sut.at("C")[r]), measure.of(sut.at("C'")[r])) << measure.key;
      EXPECT_EQ(measure.of(sut.at("C")[r]), measure.of(sut.at("C+")[r])) << measure.key;
    }
  }
}

TEST(RepeatsTest, WithoutAnAugmentedModelCPlusIsCPrime) {
  const Conditions sut = run(looped(false), 2, 1);
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_EQ(sut.at("C+")[r].label, "C+");
    EXPECT_EQ(sut.at("C+")[r].metrics.rms_error_mm, sut.at("C'")[r].metrics.rms_error_mm);
  }
}

TEST(RepeatsTest, AnInterruptEndsThem) {
  RepeatOptions options{50, 1, [](double) { return false; }};
  EXPECT_THROW(run_repeats(looped(true), short_protocol(), {}, options), diagnosis::Interrupted);
}

}  // namespace
}  // namespace stillhand::close_the_loop::repeats_test
