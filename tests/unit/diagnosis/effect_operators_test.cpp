// SPDX-License-Identifier: Apache-2.0
// How a nonlinearity sits in the body, and the small parts that several kinds share.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/loop.hpp"

namespace stillhand::diagnosis::effect_operators_test {

using testing::ElementsAre;

// With e, n and m in differences: of the output e_0 q^-1 + e_1 q^-1 (1 - q^-1).
TEST(LoopPathTest, CoefficientsAreTurnedIntoPowersOfTheDelay) {
  Effect effect{"dead_zone", "play of the output", {}, {{"threshold", "N", 1.0}}, {0.5, 0.25}};
  const LoopPath of_output = loop_path(effect, 2);
  EXPECT_TRUE(of_output.of_output());
  EXPECT_THAT(of_output.e, ElementsAre(0.0, 0.75, -0.25));
  effect.coefficients = {1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.5, 0.25};
  const LoopPath inside = loop_path(effect, 2);
  EXPECT_FALSE(inside.of_output());
  // 1 + 2 (1 - q) + 3 (1 - 2 q + q^2).
  EXPECT_THAT(inside.e, ElementsAre(6.0, -8.0, 3.0));
  EXPECT_THAT(inside.n, ElementsAre(4.0, 0.0, 0.0));
  EXPECT_THAT(inside.m, ElementsAre(0.0, 0.75, -0.25)) << "no term of its own sample";
}

TEST(LoopPathTest, TheNumberOfCoefficientsIsThatOfThePlace) {
  const Nonlinearity spring;
  const Nonlinearity stop{.stop = 1.0};
  for (const std::size_t count : {0u, 3u, 4u, 5u, 14u}) {
    EXPECT_EQ(fits_loop(count, spring, 4), count == 4 || count == 14) << count;
    EXPECT_EQ(fits_loop(count, stop, 4), count == 0) << count;
  }
  EXPECT_FALSE(fits_loop(0, stop, 0)) << "a static body has nothing to forget";
}

// y = z - phi(z) into A y = B u: A z = B u + (A - 1) phi(z).
TEST(LoopPathTest, AStopActsWithinTheSample) {
  Effect effect{"output_saturation", "stop above", {}, {constant("limit", "N", 0.5)}, {}};
  const LoopPath sut = loop_path(effect, 2);
  EXPECT_TRUE(sut.of_output());
  EXPECT_THAT(sut.e, ElementsAre(-1.0, 0.0, 0.0));
  EXPECT_THAT(sut.to_argument({1.0, -1.5, 0.7}), ElementsAre(0.0, -1.5, 0.7));
  effect.share = 0.25;
  EXPECT_THAT(loop_path(effect, 2).e, ElementsAre(-0.25, 0.0, 0.0));
}

TEST(EffectPartsTest, AQuantileIsTheValueBelowWhichAShareLies) {
  const std::vector<double> x{5.0, 1.0, 4.0, 2.0, 3.0};
  EXPECT_EQ(quantile_of(x, 0.0), 1.0);
  EXPECT_EQ(quantile_of(x, 0.5), 3.0);
  EXPECT_EQ(quantile_of(x, 0.74), 3.0) << "the position is rounded down";
  EXPECT_EQ(quantile_of(x, 0.75), 4.0);
  EXPECT_EQ(quantile_of(x, 1.0), 5.0);
  EXPECT_EQ(quantile_of({7.0}, 0.3), 7.0);
}

TEST(EffectPartsTest, DeviationIsAboutTheMean) {
  EXPECT_EQ(deviation_of({3.0, 3.0, 3.0}), 0.0);
  EXPECT_EQ(deviation_of({1.0, 3.0, 1.0, 3.0}), 1.0);
  // 2^40 is far above the spread of 1: the mean is taken off first.
  const double far = std::ldexp(1.0, 40);
  EXPECT_EQ(deviation_of({far - 1.0, far + 1.0}), 1.0);
}

TEST(EffectPartsTest, TheBestProposalsComeFirstAndEqualOnesKeepTheirOrder) {
  const auto proposal = [](const char* form, double gain) {
    return Proposal{{"tone", form, {}, {}, {}}, gain, {}};
  };
  const double never = -std::numeric_limits<double>::infinity();
  const std::vector<Proposal> all{proposal("a", 0.1), proposal("ran away", never),
                                  proposal("b", 0.3), proposal("c", 0.3), proposal("d", 0.2)};
  const auto forms = [](const std::vector<Proposal>& proposals) {
    std::vector<std::string> names;
    for (const Proposal& each : proposals) names.push_back(each.effect.form);
    return names;
  };
  EXPECT_THAT(forms(best_of(all, 3)), ElementsAre("b", "c", "d"));
  EXPECT_THAT(forms(best_of(all, 99)), ElementsAre("b", "c", "d", "a", "ran away"));
  EXPECT_TRUE(best_of({}, 3).empty());
  EXPECT_TRUE(best_of(all, 0).empty());
}

TEST(EffectPartsTest, ANumberHasThreeDigitsAndItsUnit) {
  EXPECT_EQ(with_unit(3.14159, "N"), "3.14 N");
  EXPECT_EQ(with_unit(-0.5, "-"), "-0.5");
  EXPECT_EQ(with_unit(2.0, ""), "2");
  EXPECT_EQ(with_unit(1234567.0, "m"), "1.23e+06 m");
}

}  // namespace stillhand::diagnosis::effect_operators_test
