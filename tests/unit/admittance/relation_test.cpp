// SPDX-License-Identifier: Apache-2.0
// 3 s.
#include "services/core/admittance/relation.hpp"

#include <gmock/gmock.h>

#include "services/core/contract/config_error.hpp"
#include "tests/support/rig_record.hpp"

namespace stillhand::admittance::relation_test {
namespace {

// Three records of the rig: stick free, free with the lines swapped, pegged.
RelationTest relation_of(const rig::RigConfig& config) {
  ExcitationConfig excitation{.period_s = 10.0, .lowest_hz = 0.1, .lines = 12};
  const Excitation straight = design(excitation);
  excitation.swapped = true;
  const Excitation swapped = design(excitation);
  // The same lines at the records' rate.
  excitation.rate_hz = 250.0;
  const Excitation read_swapped = design(excitation);
  excitation.swapped = false;
  const Excitation read = design(excitation);
  simulated::RigRun run{.rig = config, .motion = &straight.motion, .force = &straight.force};
  const LineEstimates free = estimate(simulated::record(run).record, read);
  run.motion = &swapped.motion;
  run.force = &swapped.force;
  const LineEstimates other = estimate(simulated::record(run).record, read_swapped);
  run.motion = &straight.motion;
  run.force = nullptr;
  run.pegged = true;
  const auto held = estimate_pegged(simulated::record(run).record, read);
  return test_relation(free.feedthrough_to_position, held, other.stick_per_force, free.neighbours);
}

rig::RigConfig linear_hand() {
  rig::RigConfig config;
  config.body.neuromuscular = {.involuntary_force_n = 0.2};
  config.stick.coulomb_friction_n = 0.0;
  config.body.cocontraction_stiffness_factor = 1.0;
  config.body.cocontraction_damping_factor = 1.0;
  return config;
}

TEST(RelationTest, TheMedianOfAnEvenNumberOfLinesIsBetweenTheTwoInTheMiddle) {
  std::vector<LineResponse> moved(4);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    moved[k].frequency_hz = static_cast<double>(k);
    moved[k].response = 1.0;
  }
  const std::vector<LineResponse> held = moved;
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k].response += 0.1 * static_cast<double>(k);
  // Mismatches 0, 0.1, 0.2 and 0.3; a rounding error of the quotient.
  EXPECT_NEAR(test_relation(moved, held, held, 8).median_mismatch, 0.15, 1e-12);
}

// A linear arm that does the same on the peg: 95 % of 12 circles, which are wider than needed (the
// fewest neighbours); 9 of 12 would be below that by 3 standard deviations.
TEST(RelationTest, HoldsForALinearArmThatDoesTheSameOnThePeg) {
  const RelationTest sut = relation_of(linear_hand());
  EXPECT_GE(sut.share_within, 0.75);
  EXPECT_LT(sut.median_radius, 0.5);  // the data could have shown a mismatch
}

// The idle hand of the pegged stick, half as stiff: the relation fails by far more than its circle.
TEST(RelationTest, FailsWhereThePeggedHandIsAnother) {
  rig::RigConfig config = linear_hand();
  config.body.cocontraction_stiffness_factor = 2.0;
  config.body.cocontraction_damping_factor = 1.41;
  const RelationTest sut = relation_of(config);
  EXPECT_LT(sut.share_within, 0.75);
  EXPECT_GT(sut.median_mismatch, relation_of(linear_hand()).median_mismatch);
}

TEST(RelationTest, RefusesRecordsWithDifferentLines) {
  std::vector<LineResponse> lines(2);
  std::vector<LineResponse> others(2);
  others[1].frequency_hz = 3.0;
  EXPECT_THAT([&] { test_relation(lines, lines, others, 14); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("different lines")));
}

}  // namespace
}  // namespace stillhand::admittance::relation_test
