// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/repair/repair.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/close_the_loop/repair_output.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/population/population.hpp"

namespace stillhand::close_the_loop::repair_test {
namespace {

constexpr double kGain_kg = 3.0;  // a body without dynamics

PersonModel mean_person() { return {cancellation::kAverageHand, population::mean_subject({}).who}; }

// 20 s of 1.2 Hz, the target at rest.
Course shaken(double factor = 1.0) {
  Course out;
  for (int n = 0; n < 20'000; ++n) {
    const double a = 1.6 * factor * std::sin(kTwoPi * 1.2 * n * kControlPeriod_s);
    cancellation::ChannelSample sensed{};
    sensed[static_cast<std::size_t>(cancellation::Channel::kAccelY)] = a;
    out.sensed.push_back(sensed);
    out.force_n.push_back(kGain_kg * a);
    out.target_m.push_back(0.0);
  }
  return out;
}

cancellation::ControlModel static_model() {
  return cancellation::control_model(signal::DifferenceModel{kControlRateHz, {kGain_kg}, {1.0}});
}

double error_mm(const Course& course, const Drive& drive, bool cancels, std::uint64_t seed = 1) {
  const auto model = static_model();
  return tracking_error_mm(mean_person(), course, drive, cancels ? &model : nullptr, {}, seed);
}

TEST(PersonLoopTest, TheSeedAloneDrawsTheRemnant) {
  EXPECT_EQ(error_mm(shaken(), {}, false), error_mm(shaken(), {}, false));
  EXPECT_NE(error_mm(shaken(), {}, false, 1), error_mm(shaken(), {}, false, 2));
}

TEST(PersonLoopTest, ACancellerThatKnowsTheForceLeavesTheErrorOfAHandAtRest) {
  const double at_rest = error_mm(shaken(0.0), {}, false);
  const double left = error_mm(shaken(), {}, true);
  const double without = error_mm(shaken(), {}, false);
  EXPECT_LT(left - at_rest, 0.1 * (without - at_rest));
}

TEST(PersonLoopTest, ALateMotorLeavesMore) {
  Drive late;
  late.late_s = 0.05;  // 22 degrees of 1.2 Hz: more than a third of the force is left
  EXPECT_GT(error_mm(shaken(), late, true), error_mm(shaken(), {}, true));
}

TEST(PersonLoopTest, FrictionHoldsAForceThatIsSmallerThanItself) {
  Drive stuck;
  stuck.friction_n = 60.0;
  // The stick and the target stand still.
  EXPECT_EQ(error_mm(shaken(), stuck, false), 0.0);
}

TEST(PersonLoopTest, AnUnsoundModelIsRefused) {
  const auto unstable =
      cancellation::control_model(signal::DifferenceModel{kControlRateHz, {1.0, 0.0}, {1.0, -1.1}});
  EXPECT_THROW(tracking_error_mm(mean_person(), shaken(), {}, &unstable, {}, 1), ConfigError);
}

Estimate change(double mean, double half) {
  return {{mean}, mean, std::pair{mean - half, mean + half}};
}

std::string advice(const Estimate& mending, const Estimate& cancelling) {
  Worth worth;
  worth.by_mending_mm = mending;
  worth.by_cancelling_mm = cancelling;
  return worth.advice();
}

TEST(WorthTest, MendingIsAdvisedWhereItGainsMoreForCertain) {
  EXPECT_EQ(advice(change(-3.0, 0.5), change(-1.0, 0.2)), "mend");
  EXPECT_EQ(advice(change(-1.2, 0.5), change(-1.0, 0.2)), "cancel");
  EXPECT_EQ(advice(change(-1.2, 0.5), change(0.0, 0.2)), "mend");
  EXPECT_EQ(advice(change(-0.2, 0.5), change(-1.0, 0.2)), "cancel");
  EXPECT_EQ(advice(change(-0.2, 0.5), change(0.3, 0.2)), "leave");
}

TEST(RepairListTest, IsEmptyWithoutAFindingThatCounts) {
  LoopResult result;
  result.rounds.resize(1);
  Finding small;
  small.counts = false;
  result.rounds[0].verdict.findings = {small};
  EXPECT_TRUE(repair_list(result, {}).effects.empty());
}

TEST(RepairOutputTest, WhatIsNotPredictedHasTheReasonInPlaceOfNumbers) {
  Worth drift;
  drift.kind = "drift";
  drift.why_not = "of time alone";
  const RepairList list{{drift}, 20.0, 21.0};
  const auto json = repair_json(list)["effects"][0];
  EXPECT_EQ(json["why_not"], "of time alone");
  EXPECT_FALSE(json.contains("change_mm"));
  EXPECT_EQ(repair_table(list).rows.front().back().text, "of time alone");
  EXPECT_TRUE(repair_figure(list).panels.front().series.empty());
}

}  // namespace
}  // namespace stillhand::close_the_loop::repair_test
