// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/partial_coherence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::partial_coherence_test {

constexpr std::size_t kCount = 6000;

CoherenceResult coherence_in(const std::vector<double>& residual, const std::vector<double>& u,
                             const std::vector<double>& v, double pause_s = 0.0) {
  Measurement measurement =
      made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", made::white(u.size(), 9)}});
  if (pause_s > 0.0) measurement = made::cut_in_two(measurement, u.size() / 3, pause_s);
  const Signals signals(measurement, {"u"}, "y");
  const Eigen::Map<const Eigen::VectorXd> r(residual.data(),
                                            static_cast<Eigen::Index>(residual.size()));
  return coherence_of(r, std::vector<double>(u.size(), 1.0), signals);
}

// Both have white spectra: the coherence is 1/(1 + 0.25) at every line, with a bias of
// (1 - c)^2 / n_d and a spread that 126 lines average.
TEST(PartialCoherenceTest, ACoherentShareIsSignalOverSignalAndNoise) {
  const auto v = made::white(kCount, 2);
  const CoherenceResult sut =
      coherence_in(made::mix({{1.0, v}, {0.5, made::white(kCount, 3)}}), made::ride(kCount, 1), v);
  ASSERT_EQ(sut.partial.size(), 1u);
  EXPECT_EQ(sut.partial[0].channel, "v");
  EXPECT_TRUE(sut.partial[0].significant);
  double mean = 0.0;
  for (const double c : sut.partial[0].coherence) mean += c;
  EXPECT_NEAR(mean / static_cast<double>(sut.partial[0].coherence.size()), 0.8, 0.02);
  // A twentieth of the record: 256 samples, 45 halfway over each other, lines 2 to 127; DG-46.
  const double averages = 45.0 / (1.0 + 44.0 / 45.0 / 18.0);
  EXPECT_NEAR(sut.independent_averages, averages, 1e-9);
  ASSERT_EQ(sut.frequency_hz.size(), 126u);
  EXPECT_DOUBLE_EQ(sut.frequency_hz.front(), 2.0 * made::kRateHz / 256.0);
  EXPECT_NEAR(sut.partial_threshold, 1.0 - std::pow(0.01 / 126.0, 1.0 / (averages - 2.0)), 1e-9);
  EXPECT_NEAR(sut.ordinary_threshold, 1.0 - std::pow(0.01 / 126.0, 1.0 / (averages - 1.0)), 1e-9);
  const ChannelCoherence& u = sut.ordinary[0];
  EXPECT_NEAR(u.p, std::min(1.0, 126.0 * std::pow(1.0 - u.highest, averages - 1.0)), 1e-9);
}

// 20 000 samples know the power to 1 %, a line of 100 records of 11 segments the density to 3 %. By
// chance the input explains one of 11 averages, 9 % of the power, which the estimate gives back.
TEST(PartialCoherenceTest, WhatNoInputTellsHasItsWholePower) {
  double power = 0.0;
  double density = 0.0;
  for (std::uint64_t i = 0; i < 300; i += 3) {
    const auto white = [i](std::uint64_t seed) { return made::white(200, i + seed); };
    const CoherenceResult sut = coherence_in(white(0), white(1), white(2));
    power += 0.01 * sut.incoherent_rms * sut.incoherent_rms;
    density += 0.01 * sut.residual_density[5];
  }
  EXPECT_NEAR(power, 1.0, 0.03);
  EXPECT_NEAR(density * made::kRateHz / 2.0, 1.0, 0.1);
}

TEST(PartialCoherenceTest, APathIsSeenWhereItIs) {
  const auto v = made::white(kCount, 5);
  const auto mode = made::answer({0.01}, made::mode(12.0, 0.02), v);
  const CoherenceResult sut = coherence_in(made::mix({{1.0, mode}, {0.5, made::white(kCount, 6)}}),
                                           made::ride(kCount, 4), v);
  EXPECT_TRUE(sut.partial[0].significant);
  EXPECT_NEAR(sut.partial[0].highest_hz, 12.0, 0.8);  // two lines
  // Far from the mode there is nothing.
  for (std::size_t k = 0; k < sut.frequency_hz.size(); ++k) {
    if (sut.frequency_hz[k] > 30.0) {
      EXPECT_LT(sut.partial[0].coherence[k], sut.partial_threshold);
    }
  }
}

// v is the input and something of its own, the residual is the input's answer and something else:
// together they go, but only by the input.
TEST(PartialCoherenceTest, WhatTheInputTellsIsTakenOut) {
  const auto u = made::white(kCount, 7);
  const auto v =
      made::mix({{1.0, made::answer({1.0}, {1.0, -0.5}, u)}, {0.5, made::white(kCount, 8)}});
  const auto r =
      made::mix({{1.0, made::answer({0.3, 0.2}, {1.0, 0.3}, u)}, {0.2, made::white(kCount, 10)}});
  const CoherenceResult sut = coherence_in(r, u, v);
  EXPECT_FALSE(sut.partial[0].significant);
  ASSERT_EQ(sut.ordinary.size(), 1u);
  EXPECT_EQ(sut.ordinary[0].channel, "u");
  EXPECT_TRUE(sut.ordinary[0].significant);
  // What isn't of the input: white noise of 0.2; 6000 samples, half overlapping windows.
  EXPECT_NEAR(sut.incoherent_rms, 0.2, 0.01);
}

TEST(PartialCoherenceTest, AChannelThatIsTheInputTellsNothingMore) {
  const auto u = made::white(kCount, 11);
  const CoherenceResult sut =
      coherence_in(made::mix({{0.5, u}, {0.2, made::white(kCount, 12)}}), u, made::mix({{3.0, u}}));
  EXPECT_FALSE(sut.partial[0].significant);
  EXPECT_EQ(sut.partial[0].highest, 0.0);
}

// How many of 400 recordings have a coherence that is called significant, at 1 %.
int alarms(double residual_pole, double pause_s) {
  int count = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto r = made::answer({1.0}, {1.0, -residual_pole}, made::white(2400, 3 * seed + 5000));
    const CoherenceResult sut = coherence_in(r, made::ride(2400, 3 * seed + 5001),
                                             made::ride(2400, 3 * seed + 5002), pause_s);
    count += sut.partial[0].significant ? 1 : 0;
    count += sut.ordinary[0].significant ? 1 : 0;
  }
  return count;
}

// 1 % of 800 are 8 with a deviation of 2.8: at most 18, in three and a half.  Lines of a Hann
// window are no independent tests, so there are fewer.
TEST(PartialCoherenceTest, IndependentNoiseIsRarelySignificant) {
  EXPECT_LE(alarms(0.0, 0.0), 18);
  EXPECT_LE(alarms(0.95, 0.0), 18);
  EXPECT_LE(alarms(0.0, 0.5), 18);
}

TEST(PartialCoherenceTest, ARecordTooShortIsNotComputed) {
  const CoherenceResult sut =
      coherence_in(made::white(80, 1), made::white(80, 2), made::white(80, 3));
  EXPECT_EQ(sut.independent_averages, 0.0);
  EXPECT_TRUE(sut.frequency_hz.empty());
  EXPECT_TRUE(sut.partial.empty());
}

}  // namespace stillhand::diagnosis::partial_coherence_test
