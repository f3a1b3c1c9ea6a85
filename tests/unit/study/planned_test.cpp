// SPDX-License-Identifier: Apache-2.0
// Planned comparisons and Eq. SU-13.
#include "apps/study/subjects/planned.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "services/core/statistics/power.hpp"
#include "tests/unit/study/made_record.hpp"

namespace stillhand::study::planned_test {
namespace {

TEST(PlannedTest, AnyPairOfConditionsIsComparedAndHolmsFactorsAreOverAllTests) {
  const Analysis analysis = analyse(made::random_results(12, "ABC", 5));
  const auto sut = planned_comparisons(analysis, {{kA, kC}, {kC, kB}, {kA, kD}});
  ASSERT_EQ(sut.size(), 2u);  // D was not run
  double smallest = 1.0;
  double adjusted = 1.0;
  for (const auto& planned : sut) {
    for (std::size_t k = 0; k < kMetricCount; ++k) {
      EXPECT_GE(*planned.p_holm[k], planned.comparison.tests[k]->p);
      if (planned.comparison.tests[k]->p >= smallest) continue;
      smallest = planned.comparison.tests[k]->p;
      adjusted = *planned.p_holm[k];
    }
  }
  EXPECT_DOUBLE_EQ(adjusted, std::min(1.0, 6.0 * smallest));
  const auto back = planned_comparisons(analysis, {{kB, kC}});
  EXPECT_DOUBLE_EQ(back[0].comparison.tests[0]->t, -sut[1].comparison.tests[0]->t);
}

TEST(PlannedTest, TheNumberIsTheSmallestWithThatPower) {
  const Analysis analysis = analyse(made::random_results(12, "ABC", 5));
  const auto sut = participants_needed(analysis, {{kA, kB}}, {0.8}, 0.05);
  ASSERT_EQ(sut.size(), 9u);  // three metrics: observed, half of it, given
  EXPECT_DOUBLE_EQ(sut[1].effect_dz, sut[0].effect_dz / 2.0);
  // statsmodels' TTestPower at d_z = 0.8: 0.7901 with 14, 0.8213 with 15, 0.8920 with 18, 0.9092
  // with 19.
  EXPECT_EQ(sut[2].effect, "given");
  ASSERT_EQ(sut[2].at.size(), 2u);
  EXPECT_EQ(sut[2].at[0].participants, 15u);
  EXPECT_EQ(sut[2].at[1].participants, 19u);
  for (const Needed& needed : sut) {
    for (const Needed::At& at : needed.at) {
      EXPECT_GE(at.power, at.wanted_power);
      EXPECT_EQ(at.power, statistics::paired_t_power(needed.effect_dz, at.participants));
    }
  }
}

TEST(PlannedTest, AnEffectNearNothingHasNoNumber) {
  auto results = made::random_results(3, "AB", 5);
  // Differences -1, 0, 1 + 1e-9: d_z near 3e-10.
  for (int i = 0; i < 3; ++i) {
    auto& at = results[static_cast<std::size_t>(i)].trials;
    at.at(kA).metrics.rms_error_mm = 30.0;
    at.at(kB).metrics.rms_error_mm = 29.0 + i + (i == 2 ? 1e-9 : 0.0);
  }
  const auto sut = participants_needed(analyse(results), {{kA, kB}}, {}, 0.05);
  EXPECT_EQ(sut[0].metric, 0u);
  EXPECT_TRUE(sut[0].at.empty());
}

}  // namespace
}  // namespace stillhand::study::planned_test
