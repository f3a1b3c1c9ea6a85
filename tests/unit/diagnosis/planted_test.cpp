// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "services/core/diagnosis/diagnose.hpp"
#include "tests/planted/recording.hpp"
#include "tests/planted/to_measurement.hpp"

// Recordings of a simulator that shares no code with the engine, in a few clear cases: 40 s,
// an effect of a quarter of the force, noise of a hundredth.  tests/benchmark/planted_effects.cpp
// measures how often the engine is right.
namespace stillhand::diagnosis::planted_test {

Diagnosis diagnosis_of(std::uint64_t seed, std::vector<planted::Kind> kinds) {
  planted::Spec spec;
  spec.kinds = std::move(kinds);
  spec.strengths = {0.25};
  spec.snr_db = 40.0;
  spec.least_evidence = spec.kinds.empty() ? 0.0 : 1000.0;
  spec.length_s = 40.0;
  return diagnose(planted::to_measurement(planted::draw(seed, spec).recording), {});
}

TEST(PlantedTest, AStrongEffectIsNamedFirst) {
  for (const planted::Kind kind : {planted::Kind::kCoupledInput, planted::Kind::kCoulombFriction}) {
    SCOPED_TRACE(planted::name_of(kind));
    const Diagnosis sut = diagnosis_of(1, {kind});
    ASSERT_FALSE(sut.effects.empty());
    EXPECT_EQ(sut.effects[0].effect.kind, planted::name_of(kind));
    EXPECT_LT(sut.final_error.rmse, 0.5 * sut.baseline_error.rmse);
  }
}

TEST(PlantedTest, WhereNothingIsPlantedNothingIsFound) {
  const Diagnosis sut = diagnosis_of(1, {});
  EXPECT_EQ(sut.verdict(), "nothing missing");
  // Noise of -40 dB: 1e-4 of the variance.
  EXPECT_GT(sut.final_error.vaf_percent, 99.9);
}

}  // namespace stillhand::diagnosis::planted_test
