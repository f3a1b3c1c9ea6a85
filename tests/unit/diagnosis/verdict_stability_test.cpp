// SPDX-License-Identifier: Apache-2.0
// Eq. DG-83: does the verdict come back?
#include "services/core/diagnosis/verdict_stability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::verdict_stability_test {

using testing::ElementsAre;
using testing::Pair;

constexpr std::size_t kRows = 3000;

// y = 2 u + noise, and a friction with the sign of a rate that adds `friction` N.
Measurement with_friction(double friction) {
  const auto u = made::ride(kRows, 1);
  const auto omega = made::ride(kRows, 2);
  auto y = made::mix({{2.0, u}, {0.2, made::white(kRows, 3)}});
  for (std::size_t n = 0; n < kRows; ++n) y[n] += std::copysign(friction, omega[n]);
  return made::measurement_of({{"u", "m/s^2", u}, {"omega", "rad/s", omega}, {"y", "N", y}});
}

DiagnoseOptions options_of() {
  DiagnoseOptions options;
  options.inputs = {"u"};
  options.output = "y";
  return options;
}

TEST(VerdictStabilityTest, AClearEffectAndNothingComeBackAlways) {
  for (const auto& [friction, name] :
       {std::pair{1.0, "coulomb_friction"}, {0.0, "nothing missing"}}) {
    const NameCounts sut = verdict_stability(with_friction(friction), options_of(), 4);
    EXPECT_THAT(sut.counts, ElementsAre(Pair(name, 4)));
  }
}

TEST(VerdictStabilityTest, AFifthOfTheRecordWeighsNothingEachTimeAnother) {
  const Measurement measurement = with_friction(1.0);
  const Measurement one = disturbed(measurement, "y", 1);
  const Measurement other = disturbed(measurement, "y", 2);
  EXPECT_EQ(std::ranges::count(one.weight, 0.0), static_cast<std::ptrdiff_t>(kRows / 5));
  EXPECT_NE(one.weight, other.weight);
  EXPECT_EQ(one.weight, disturbed(measurement, "y", 1).weight);
  EXPECT_EQ(one.find("u")->values, measurement.find("u")->values);
  // 1e-13 times a normal number of 6 at most.
  for (std::size_t n = 0; n < kRows; ++n) {
    const double y = measurement.find("y")->values[n];
    EXPECT_NEAR(one.find("y")->values[n], y, 6e-13 * std::abs(y));
  }
}

}  // namespace stillhand::diagnosis::verdict_stability_test
