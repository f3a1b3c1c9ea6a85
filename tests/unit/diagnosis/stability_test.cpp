// SPDX-License-Identifier: Apache-2.0
// What is proved of a model, and what is refused, Eq. DG-57.
#include "services/core/diagnosis/model/stability.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "services/core/diagnosis/model/other_phases.hpp"
#include "services/core/diagnosis/model/seen_range.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::stability_test {

constexpr std::size_t kCount = 3001;

Signals signals_of(double scale = 1.0) {
  std::vector<double> u = made::ride(kCount, 1);
  for (double& value : u) value *= scale;
  return made::signals_of(u, made::white(kCount, 2));
}

// A y = B u + q^-1 (e_0 + e_1 D) phi(y / threshold)
Model looped(const char* kind, const char* form, double threshold, double e0, double e1) {
  Model model =
      made::model_of(made::two_pole_body(),
                     {{kind, form, {}, {{"threshold", "N", threshold, 1e-3, 1e3}}, {e0, e1}}});
  note_seen(model, signals_of());
  return model;
}

TEST(StabilityTest, ALinearModelIsProved) {
  EXPECT_EQ(stability_of(made::model_of(made::four_pole_body()), signals_of()), Stability::kProved);
  Model unstable = made::model_of(made::two_pole_body());
  unstable.body.denominator = {1.0, -2.1, 1.1};
  EXPECT_EQ(stability_of(unstable, signals_of()), Stability::kRefused);
}

TEST(StabilityTest, ASlightSpringIsProved) {
  const Model sut = looped("nonlinear_stiffness", "levelled of the output", 1.0, 0.005, 0.0);
  EXPECT_EQ(stability_of(sut, signals_of()), Stability::kProved);
}

// With memory there is no slope at a place: the criterion does not hold for it.  Nor does it for a
// spring four times as stiff within its gap as beyond: between the resonances of the soft and the
// stiff body, 3 and 6 Hz, the soft one's response has turned round and the stiff one's has not yet,
// so that they are more than a right angle apart.
TEST(StabilityTest, WhatTheCriterionDoesNotHoldForIsTested) {
  for (const Model& sut : {looped("hysteresis", "elastic-plastic of the output", 1.0, 0.005, 0.0),
                           looped("dead_zone", "play of the output", 1.0, -0.1, 0.0)}) {
    EXPECT_EQ(stability_of(sut, signals_of()), Stability::kTested) << sut.effects[0].kind;
  }
}

// 1 - p q^-1 with p = 0.5 beyond the play and 0.5 + e_0 within it: of one pole the two responses
// are less than a right angle apart at each frequency where both poles lie within the unit circle.
TEST(StabilityTest, OfOnePoleTheCriterionIsThatBothBodiesAreStable) {
  for (const auto& [e0, proved] :
       {std::pair{0.45, true}, {0.55, false}, {-1.45, true}, {-1.55, false}}) {
    Model sut = made::model_of(
        {{{0.0, 1.0}}, {1.0, -0.5}},
        {{"dead_zone", "play of the output", {}, {{"threshold", "N", 1.0, 1e-3, 1e3}}, {e0}}});
    note_seen(sut, signals_of());
    EXPECT_EQ(stability_of(sut, signals_of()) == Stability::kProved, proved) << e0;
  }
}

// x y* at line k: each line keeps its size, and two signals their angle to each other.
std::complex<double> shared(const std::vector<double>& x, const std::vector<double>& y, int k) {
  const double hz = k * made::kRateHz / static_cast<double>(x.size());
  return made::response({{x}, {1.0}}, hz) * std::conj(made::response({{y}, {1.0}}, hz));
}

// Eq. DG-57 d.
TEST(StabilityTest, ASurrogateHasTheSameSpectrumAndOtherPhases) {
  const auto x = made::white(256, 3);
  const auto y = made::white(256, 4);
  const auto sut = other_phases(x, {57, 1});
  const auto of_y = other_phases(y, {57, 1});
  for (int k = 0; k <= 128; ++k) {
    EXPECT_LT(std::abs(shared(sut, sut, k) - shared(x, x, k)), 1e-8) << k;
    EXPECT_LT(std::abs(shared(sut, of_y, k) - shared(x, y, k)), 1e-8) << k;
  }
  // Four standard errors of a correlation, 1/sqrt(256).
  EXPECT_LT(std::abs(made::column_of(sut).dot(made::column_of(x))) / 256.0, 0.25);
  // What is filled up to a power of two is spread over all: 4096 for 3000.
  EXPECT_NEAR(made::rms_of(other_phases(made::ride(3000, 5), {57, 1})), 1.0, 0.1);
}

// a_2 = 0.893 with e_1 = 1.5 over a threshold of 10: a pole pair of radius sqrt(1.043) while |y| is
// below it, and a stable body beyond.  It swings by itself, far above the ride's 2 N.
TEST(StabilityTest, ALoopThatSwingsByItselfIsRefused) {
  const Model sut = looped("dead_zone", "play of the output", 10.0, 0.0, 1.5);
  const FreeRun run = free_run(sut, signals_of());
  ASSERT_TRUE(run.finite);
  EXPECT_EQ(stability_of(sut, signals_of()), Stability::kRefused);
}

// A(1) less a slope of e_0 below 1 N, Eq. DG-95: it pushes outwards there by more than a tenth of
// A(1), by less, or nowhere.
TEST(StabilityTest, ASpringTurnsRoundWhereItsStiffnessChangesItsSign) {
  const auto& a = made::two_pole_body().denominator;
  for (const auto& [over, turns] :
       {std::pair{2.0, true}, {1.15, true}, {1.05, false}, {0.6, false}}) {
    const Model sut =
        looped("dead_zone", "play of the output", 1.0, over * (a[0] + a[1] + a[2]), 0.0);
    EXPECT_EQ(turns_round(sut, signals_of()), turns) << over;
  }
  EXPECT_FALSE(turns_round(made::model_of(made::two_pole_body()), signals_of()));
}

// (1 - b q^-1)^3: rounding of 1e-16 moves a triple root by its third root, 5e-6, beyond b.
TEST(StabilityTest, PolesOnTheBoundOfTheFitAreStable) {
  constexpr double kBound = 0.904837;
  Model sut =
      made::model_of({{{0.0, 0.1, 0.0, 0.0}},
                      {1.0, -3.0 * kBound, 3.0 * kBound * kBound, -kBound * kBound * kBound}});
  sut.body.largest_radius = sut.body.slowest_radius = kBound;
  ASSERT_FALSE(is_stable(sut.body)) << "no pole is moved beyond the bound";
  EXPECT_EQ(stability_of(sut, signals_of()), Stability::kProved);
}

// Held at its edges its force is bounded, so its output is.  Without a range a cube runs away on
// what is ten times as large.
TEST(StabilityTest, WhatWasRefusedOrNotIsBoundedOnAnyInput) {
  Model sut = looped("nonlinear_stiffness", "cubic of the output", 0.7, 0.02, 0.0);
  EXPECT_TRUE(free_run(sut, signals_of(100.0)).finite);
  sut.effects[0].seen.clear();
  EXPECT_FALSE(free_run(sut, signals_of(100.0)).finite);
  EXPECT_EQ(stability_of(sut, signals_of()), Stability::kRefused) << "no range, nothing held";
}

TEST(StabilityTest, NamesAreThoseOfTheFile) {
  EXPECT_EQ(name_of(Stability::kProved), "proved");
  EXPECT_EQ(name_of(Stability::kTested), "tested");
  EXPECT_EQ(name_of(Stability::kRefused), "refused");
}

}  // namespace stillhand::diagnosis::stability_test
