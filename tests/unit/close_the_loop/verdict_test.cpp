// SPDX-License-Identifier: Apache-2.0
// The verdict of the loop is that of `stillhand diagnose`, and an effect counts by its newtons.
#include "apps/close_the_loop/verdict/verdict.hpp"

#include <gtest/gtest.h>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::close_the_loop::verdict_test {
namespace {

namespace made = diagnosis::made;

constexpr std::size_t kCount = 6000;

// A body of four poles and a path from a_x, behind noise of 0.1 N.
diagnosis::Measurement pegged(double of_a_x, bool is_static = false) {
  const auto a_y = made::scaled_to(made::ride(kCount, 1), 1.6);
  const auto a_x = made::ride(kCount, 2);
  const auto noise = made::white(kCount, 3);
  const diagnosis::Body body = made::four_pole_body();
  std::vector<double> f = made::answer(body, a_y);
  for (std::size_t n = 0; n < kCount; ++n) {
    if (is_static) f[n] = -3.0 * a_y[n];
    f[n] += 0.1 * noise[n] + of_a_x * a_x[n];
  }
  return made::measurement_of({{"a_y", "m/s^2", a_y}, {"a_x", "m/s^2", a_x}, {"f", "N", f}});
}

Verdict verdict_of(const diagnosis::Measurement& measurement,
                   const diagnosis::DiagnoseOptions& options = {}) {
  return diagnose_all(Evidence{&measurement}, DeclaredDrive{}, options);
}

TEST(VerdictTest, OneFileHasOneVerdictInBothVerbs) {
  // 0.05 N next to 0.1 N of noise: a tenth of the error, which was too little for the loop alone.
  for (const double of_a_x : {0.0, 0.05, 0.3}) {
    const diagnosis::Measurement measurement = pegged(of_a_x);
    const diagnosis::Diagnosis alone = diagnosis::diagnose(measurement, {});
    const Verdict sut = verdict_of(measurement);
    EXPECT_EQ(sut.conclusion(), alone.verdict()) << of_a_x;
    EXPECT_EQ(sut.body.final_error.rmse, alone.final_error.rmse) << of_a_x;
    ASSERT_EQ(sut.findings.size(), alone.effects.size()) << of_a_x;
    for (std::size_t e = 0; e < sut.findings.size(); ++e) {
      EXPECT_EQ(sut.body.effects[e].effect.kind, alone.effects[e].effect.kind);
      EXPECT_EQ(sut.body.effects[e].after.rmse, alone.effects[e].after.rmse);
      EXPECT_EQ(sut.body.effects[e].counts, alone.effects[e].counts);
    }
  }
}

TEST(VerdictTest, AnEffectBelowTheLeastForceIsListedAndIsNotTheVerdict) {
  const diagnosis::Measurement measurement = pegged(0.3);
  const Verdict counts = verdict_of(measurement);
  ASSERT_NE(counts.strongest(), nullptr);
  EXPECT_EQ(counts.kind(), "coupled_input");
  // 0.3 N/(m/s^2) times 1 m/s^2 RMS; the noise of each block's mean square is 6 %.
  EXPECT_NEAR(counts.strongest()->explained_n, 0.3, 0.03);
  ASSERT_TRUE(counts.strongest()->interval95);
  EXPECT_LT(counts.strongest()->interval95->first, 0.3);
  EXPECT_GT(counts.strongest()->interval95->second, 0.3);
  EXPECT_EQ(counts.model().effects.size(), counts.body.effects.size());

  diagnosis::DiagnoseOptions options;
  options.least_force_n = 0.5;
  const Verdict sut = verdict_of(measurement, options);
  EXPECT_EQ(sut.strongest(), nullptr);
  EXPECT_EQ(sut.kind(), "none");
  EXPECT_EQ(sut.conclusion(), kNothing);
  ASSERT_EQ(sut.findings.size(), 1u);
  EXPECT_FALSE(sut.findings[0].counts);
  EXPECT_EQ(sut.findings[0].explained_n, counts.findings[0].explained_n);
  EXPECT_TRUE(sut.model().effects.empty()) << "the canceller gets the linear model";
  EXPECT_TRUE(sut.control.treatments.empty());
}

TEST(VerdictTest, AStaticBodyReachesTheCanceller) {
  const Verdict sut = verdict_of(pegged(0.3, true));
  EXPECT_EQ(sut.body.model_class, "linear");
  EXPECT_EQ(sut.not_carried, "");
  ASSERT_FALSE(sut.control.model.inputs.empty());
  EXPECT_LT(sut.control.conversion_error, 0.05);
}

TEST(VerdictTest, WhatCanBeNamedCountsAndIsFound) {
  const Verdict sut = verdict_of(pegged(0.0));
  EXPECT_EQ(detectable_n(sut, false), std::max(diagnosis::kLeastForce_n, sut.body.detection_limit));
}

}  // namespace
}  // namespace stillhand::close_the_loop::verdict_test
