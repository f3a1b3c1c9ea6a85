// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/rate_conversion.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/rig/parts/body_response.hpp"
#include "tests/support/feedthrough_records.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/rms_share.hpp"

namespace stillhand::identification::rate_conversion_test {
namespace {

using support::body_like_model;

// Independent of the conversion's own figure: 173 frequencies, only the ends on its grid.
double largest_error(const DifferenceModel& low, const DifferenceModel& high, double from_hz,
                     double to_hz) {
  double worst = 0.0;
  double peak = 0.0;
  for (int i = 0; i < 173; ++i) {
    const double f = from_hz + (to_hz - from_hz) * i / 172.0;
    worst = std::max(worst, std::abs(signal::response_at(low, f) - signal::response_at(high, f)));
  }
  for (double f = 0.7; f <= 4.0; f += 0.01) {
    peak = std::max(peak, std::abs(signal::response_at(low, f)));
  }
  return worst / peak;
}

TEST(RateConversionTest, KeepsTheResponseOfABodyLikeModel) {
  const RateConversion sut = to_control_rate(body_like_model());
  std::printf("conversion error: excited band %.3f %%, to 10 Hz %.3f %%\n",
              100.0 * sut.excited_error, 100.0 * sut.max_error);
  EXPECT_EQ(sut.model.rate_hz, kControlRateHz);
  EXPECT_EQ(sut.model.order(), 4u);
  EXPECT_TRUE(signal::is_stable(sut.model));
  // 1 % leaves 40 dB of cancellation.
  EXPECT_LT(sut.excited_error, 0.01);
  EXPECT_LT(sut.max_error, 0.02);
  EXPECT_NEAR(largest_error(body_like_model(), sut.model, 0.0, 10.0), sut.max_error,
              0.05 * sut.max_error + 1e-6);
  EXPECT_NEAR(largest_error(body_like_model(), sut.model, 0.7, 4.0), sut.excited_error,
              0.05 * sut.excited_error + 1e-6);
}

TEST(RateConversionTest, RealModelsOfLowOrderAreHit) {
  // One real pole at 2 Hz, near z = 0.78: first order in, first order out.
  const double pole = std::exp(-2.0 * 3.14159265358979 * 2.0 / 50.0);
  const RateConversion sut =
      to_control_rate({50.0, {-3.2 * (1.0 - pole), 0.0}, {1.0, -pole}}, {0.7, 4.0, 10.0, 0.2});
  EXPECT_LT(sut.excited_error, 0.02);
  // A gain alone passes unchanged, but for rounding.
  const RateConversion gain = to_control_rate({50.0, {-3.2}, {1.0}});
  EXPECT_NEAR(gain.model.numerator[0], -3.2, 1e-12);
  EXPECT_NEAR(gain.peak_gain, 3.2, 1e-12);
}

// Eq. ID-10: a pole that takes 20 s to 1 %, next to a zero that leaves it 1 % of the response, is
// moved to 4 s.
TEST(RateConversionTest, ASlowerPoleIsMovedToFourSeconds) {
  const double pole = std::exp(-std::log(100.0) / (20.0 * 50.0));
  const double zero = 1.0 - 1.01 * (1.0 - pole);
  const RateConversion sut = to_control_rate({50.0, {-3.2, 3.2 * zero}, {1.0, -pole}});
  EXPECT_NEAR(-sut.model.denominator[1], std::exp(-std::log(100.0) / 4000.0), 1e-8);
}

TEST(RateConversionTest, PolesThatNoisePutsNearNyquistDoNoHarm) {
  // Fits to noise put poles on the negative real axis and beside z = -1, with zeros close by.
  for (const double pole : {-0.3, -0.9, -0.995}) {
    DifferenceModel model = body_like_model();
    const auto extend = [](std::vector<double>& c, double root) {
      c.push_back(0.0);
      for (std::size_t i = c.size() - 1; i > 0; --i) c[i] -= root * c[i - 1];
    };
    extend(model.denominator, pole);
    extend(model.numerator, pole + 0.02);
    const RateConversion sut = to_control_rate(model);
    EXPECT_TRUE(signal::is_stable(sut.model)) << pole;
    EXPECT_LT(sut.excited_error, 0.01) << pole;
    EXPECT_LT(sut.peak_gain, 60.0) << pole;
  }
}

TEST(RateConversionTest, OrdersBeyondWhatDoublePrecisionCarriesAreLowered) {
  DifferenceModel model = body_like_model();
  for (int i = 0; i < 8; ++i) {  // eight poles at 0.1 +- i/50 beside their zeros: order 12
    model.denominator.push_back(0.0);
    model.numerator.push_back(0.0);
    for (std::size_t k = model.denominator.size() - 1; k > 0; --k) {
      model.denominator[k] -= (0.1 + 0.02 * i) * model.denominator[k - 1];
      model.numerator[k] -= (0.12 + 0.02 * i) * model.numerator[k - 1];
    }
  }
  const RateConversion sut = to_control_rate(model);
  EXPECT_EQ(sut.model.order(), 8u);
  EXPECT_LT(sut.max_error, 0.05);
}

TEST(RateConversionTest, AConversionThatMissesItsBoundIsRefused) {
  // METHOD, "Accuracy and speed": 0.37 % to 10 Hz.
  const auto convert = [] { to_control_rate(body_like_model(), {0.7, 4.0, 10.0, 0.002}); };
  EXPECT_THAT(support::refusal(convert),
              testing::HasSubstr("an error of 0.37 % of the peak gain, want at most 0.20 %"));
}

TEST(RateConversionTest, UnusableModelsAreRefused) {
  DifferenceModel unstable = body_like_model();
  unstable.denominator = {1.0, -2.2, 1.4, 0.0, 0.0};
  DifferenceModel slow = body_like_model();
  slow.rate_hz = 20.0;
  DifferenceModel broken = body_like_model();
  broken.numerator[2] = std::nan("");
  EXPECT_THROW(to_control_rate(unstable), ConfigError);
  EXPECT_THROW(to_control_rate(slow), ConfigError);
  EXPECT_THROW(to_control_rate(broken), ConfigError);
  EXPECT_THROW(to_control_rate({}), ConfigError);
}

// What each way of running the 50 Hz model at 1 kHz leaves of the force, as the share
// sqrt(mean (f - f_hat)^2 / mean f^2), for motion of 0.7 to 2 Hz.
class HoldCostTest : public ::testing::Test {
 protected:
  HoldCostTest() : a_(support::band_noise(60'000, 1000.0, 0.7, 2.0, 1.6, 5)) {
    converted_ = to_control_rate(body_like_model()).model;
    f_ = signal::simulated(converted_, a_);
  }
  [[nodiscard]] double share(const std::vector<double>& predicted) const {
    support::RmsShare left;
    for (std::size_t n = 2000; n < f_.size(); ++n) left.add(f_[n] - predicted[n], f_[n]);
    return left.value();
  }
  // The 50 Hz model on every twentieth sample, its answer held for twenty ticks.
  [[nodiscard]] std::vector<double> held() const {
    std::vector<double> sampled;
    for (std::size_t n = 0; n < a_.size(); n += 20) sampled.push_back(a_[n]);
    const auto low = signal::simulated(body_like_model(), sampled);
    std::vector<double> out;
    for (std::size_t n = 0; n < a_.size(); ++n) out.push_back(low[n / 20]);
    return out;
  }
  std::vector<double> a_;
  std::vector<double> f_;
  DifferenceModel converted_;
};

TEST_F(HoldCostTest, HoldingTheFiftyHertzAnswerCostsWhatItsDelaySays) {
  // Mean age of a held value is 9.5 ticks: at angular frequency w the residual is |1 - e^(-jw t)|
  // = w t to first order, averaged over ages 0 .. 19: sqrt(mean age^2) = 11.1 ms.  With the power
  // of the force between 0.7 and 2 Hz, w from 4.4 to 12.6 rad/s, the share lies from 4.9 % to 14 %.
  const double hold = share(held());
  std::printf("residual share at 1 kHz: zero-order hold of 50 Hz %.2f %%\n", 100.0 * hold);
  EXPECT_GT(hold, 0.049);
  EXPECT_LT(hold, 0.14);
}

TEST_F(HoldCostTest, ConvertedFilterLeavesNoneOfThat) {
  // Truth here is the 50 Hz model itself on the instants that it has: every twentieth sample.
  std::vector<double> sampled;
  for (std::size_t n = 0; n < a_.size(); n += 20) sampled.push_back(a_[n]);
  const auto low = signal::simulated(body_like_model(), sampled);
  support::RmsShare share_left;
  for (std::size_t n = 100; n < low.size(); ++n) share_left.add(low[n] - f_[20 * n], low[n]);
  const double left = share_left.value();
  std::printf("residual share at 1 kHz: converted filter %.3f %%\n", 100.0 * left);
  EXPECT_LT(left, to_control_rate(body_like_model()).excited_error * 3.0);
  EXPECT_LT(left, share(held()) / 20.0);
}

}  // namespace
}  // namespace stillhand::identification::rate_conversion_test
