// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/excitation_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "tests/support/feedthrough_records.hpp"

namespace stillhand::identification::excitation_check_test {
namespace {

std::vector<double> sines(std::initializer_list<double> frequencies_hz) {
  std::vector<double> out(3000, 0.0);
  for (const double f : frequencies_hz) {
    for (std::size_t n = 0; n < out.size(); ++n) {
      out[n] += std::sin(2.0 * std::numbers::pi * f * static_cast<double>(n) / 50.0 + f);
    }
  }
  return out;
}
Excitation of(const std::vector<double>& a) {
  return check_excitation(support::record_of(support::body_like_model(), a), 4);
}

TEST(ExcitationTest, ThePapersMotionSuffices) {
  auto a = support::band_noise(6000, 50.0, 0.7, 4.0, 1.6, 1);
  const auto noise = support::white_noise(6000, 0.01, 2);
  for (std::size_t n = 0; n < a.size(); ++n) a[n] += noise[n];
  const Excitation sut = of(a);
  EXPECT_TRUE(sut.sufficient) << sut.verdict;
  EXPECT_NEAR(sut.acceleration_rms_m_s2, 1.6, 0.01);
}

TEST(ExcitationTest, EachSinusoidCountsTwoAndWhiteNoiseTheMost) {
  EXPECT_EQ(of(support::white_noise(3000, 1.0, 4)).persistent_order, 25);
  EXPECT_EQ(of(sines({2.0})).persistent_order, 2);
  EXPECT_EQ(of(sines({1.0, 3.0, 6.0})).persistent_order, 6);
  // Nine parameters of order 4 need nine components: four sinusoids give eight, five ten.
  const auto eight = sines({1.0, 3.0, 6.0, 9.0});
  EXPECT_FALSE(of(eight).sufficient);
  EXPECT_THROW(require_excitation(support::record_of(support::body_like_model(), eight), 4),
               ConfigError);
  EXPECT_TRUE(of(sines({1.0, 3.0, 6.0, 9.0, 14.0})).sufficient);
}

TEST(ExcitationTest, VerdictSaysWhatIsMissing) {
  EXPECT_NE(of(sines({2.0})).verdict.find("holds 2 independent components"), std::string::npos);
  EXPECT_NE(of(std::vector<double>(3000, 1.0)).verdict.find("no excitation"), std::string::npos);
  EXPECT_NE(of(support::white_noise(3000, 0.01, 3)).verdict.find("no excitation"),
            std::string::npos);
  EXPECT_EQ(of(support::white_noise(3000, 1.0, 3)).verdict, "sufficient");
  // 0.05 m/s^2 RMS are needed; ten samples for each of nine parameters, and 25 lags.
  for (const double rms : {0.0499, 0.0501}) {
    auto a = sines({1.0, 3.0, 6.0, 9.0, 14.0});
    for (double& x : a) x *= rms / std::sqrt(2.5);
    EXPECT_EQ(of(a).sufficient, rms > 0.05);
  }
  EXPECT_EQ(of(support::white_noise(114, 1.0, 3)).verdict,
            "recording: got 114 samples, want 115 or more for order 4");
  EXPECT_TRUE(of(support::white_noise(115, 1.0, 3)).sufficient);
}

}  // namespace
}  // namespace stillhand::identification::excitation_check_test
