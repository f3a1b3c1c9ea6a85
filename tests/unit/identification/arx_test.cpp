// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/arx.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "tests/golden/arx/exact_fit.hpp"
#include "tests/support/feedthrough_records.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::identification::arx_test {
namespace {

using support::body_like_model;
using support::record_of;
using support::white_noise;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

double largest(const std::vector<double>& values) {
  double out = 0.0;
  for (const double v : values) out = std::max(out, std::abs(v));
  return out;
}

TEST(ArxTest, RecoversAKnownModelWithoutNoise) {
  const DifferenceModel truth = body_like_model();
  const ArxFit sut = fit_arx(record_of(truth, white_noise(3000, 1.6, 1)), 4);
  // Backward stable QR on a consistent system: relative error of the scaled parameters up to
  // kappa eps times a modest factor (Golub and Van Loan 5.3.8), with sqrt(9 * 3000) for the norms;
  // f itself carries rounding of its own recursion, another kappa eps.
  const double bound = 2.0 * std::sqrt(9.0 * 3000.0) * sut.condition_number * kEpsilon;
  ASSERT_LT(bound, 1e-6);
  for (std::size_t i = 0; i <= 4; ++i) {
    EXPECT_NEAR(sut.model.numerator[i], truth.numerator[i], bound * largest(truth.numerator));
    EXPECT_NEAR(sut.model.denominator[i], truth.denominator[i], bound * largest(truth.denominator));
  }
  EXPECT_TRUE(sut.stable);
  EXPECT_GT(sut.heldout.free_run_vaf_percent, 100.0 - 1e-6);
  EXPECT_EQ(sut.heldout.samples, 750u);
}

TEST(ArxTest, EqualsTheSolutionInExactArithmetic) {
  const Record record{
      50.0,
      {std::begin(golden::kAcceleration_m_s2), std::end(golden::kAcceleration_m_s2)},
      {std::begin(golden::kForce_n), std::end(golden::kForce_n)}};
  const ArxFit sut = fit_arx(record, 4);
  // Least squares with a residual: error of order (kappa + kappa^2 tan theta) eps, Golub and Van
  // Loan 5.3.8, with theta below the angle of one-step error to force.
  const double kappa = sut.condition_number;
  const double tangent = std::sqrt(1.0 - sut.heldout.one_step_vaf_percent / 100.0);
  const double bound = std::sqrt(9.0 * 160.0) * (kappa + kappa * kappa * tangent) * kEpsilon;
  ASSERT_LT(bound, 1e-8);
  for (std::size_t i = 0; i <= 4; ++i) {
    EXPECT_NEAR(sut.model.numerator[i], golden::kNumerator[i], bound * 5.0) << "c_" << i;
  }
  for (std::size_t j = 1; j <= 4; ++j) {
    EXPECT_NEAR(sut.model.denominator[j], golden::kDenominatorFromD1[j - 1], bound * 5.0)
        << "d_" << j;
  }
}

TEST(ArxTest, SignsAreThoseOfThePaper) {
  // Eq. 3: f(n) = c_0 a(n) + c_1 a(n-1) - d_1 f(n-1).  With f(n) = -3 a(n) + 0.6 f(n-1), d_1 is
  // -0.6.
  const auto a = white_noise(500, 1.0, 2);
  std::vector<double> f;
  for (const double x : a) f.push_back(-3.0 * x + (f.empty() ? 0.0 : 0.6 * f.back()));
  const ArxFit sut = fit_arx({50.0, a, f}, 1);
  EXPECT_NEAR(sut.model.numerator[0], -3.0, 1e-12);
  EXPECT_NEAR(sut.model.numerator[1], 0.0, 1e-12);
  EXPECT_NEAR(sut.model.denominator[1], -0.6, 1e-12);
}

TEST(ArxTest, EveryOrderFromOneToTwelveCanBeAsked) {
  auto record = record_of(body_like_model(), white_noise(4000, 1.6, 3));
  const auto noise = white_noise(4000, 0.05, 4);
  for (std::size_t n = 0; n < noise.size(); ++n) record.force_n[n] += noise[n];
  for (int order = kMinOrder; order <= kMaxOrder; ++order) {
    const ArxFit sut = fit_arx(record, order);
    EXPECT_EQ(sut.model.order(), static_cast<std::size_t>(order));
    EXPECT_EQ(sut.model.numerator.size(), static_cast<std::size_t>(order) + 1);
    EXPECT_EQ(sut.model.rate_hz, 50.0);
  }
  EXPECT_THROW(fit_arx(record, 0), ConfigError);
  EXPECT_THROW(fit_arx(record, 13), ConfigError);
}

TEST(ArxTest, TooHighAnOrderWithoutNoiseStillPredicts) {
  // Order 6 on a fourth-order record: the matrix is singular but for rounding; poles and zeros
  // cancel and the prediction stays.  Judged on one step, since where the cancelling poles come to
  // lie is not determined.
  const ArxFit sut = fit_arx(record_of(body_like_model(), white_noise(3000, 1.6, 5)), 6);
  EXPECT_GT(sut.heldout.one_step_vaf_percent, 99.9999);
}

TEST(ArxTest, HeldOutErrorIsNotThatOfTheFit) {
  // The last quarter follows another model: a quality that had seen it would be better than this.
  const auto a = white_noise(4000, 1.0, 6);
  Record record = record_of(body_like_model(), a);
  for (std::size_t n = 3000; n < 4000; ++n) record.force_n[n] *= -1.0;
  const ArxFit sut = fit_arx(record, 4);
  EXPECT_NEAR(sut.heldout.free_run_vaf_percent, -300.0, 1.0);  // error 2 f: 1 - 4
}

TEST(ArxTest, PooledRecordsGiveOneModelOfAllTheirSamples) {
  const DifferenceModel truth = body_like_model();
  const std::vector<ArxFactor> factors{factor_arx(record_of(truth, white_noise(400, 1.6, 1)), 4),
                                       factor_arx(record_of(truth, white_noise(900, 0.4, 2)), 4)};
  const DifferenceModel pooled = fit_pooled(factors);
  const double tolerance = 1e-6 * largest(truth.denominator);
  for (std::size_t i = 0; i <= 4; ++i) {
    EXPECT_NEAR(pooled.numerator[i], truth.numerator[i], tolerance);
    EXPECT_NEAR(pooled.denominator[i], truth.denominator[i], tolerance);
  }
  // One record alone is its own pool.
  const Record record = record_of(truth, white_noise(400, 1.6, 3));
  EXPECT_EQ(fit_pooled({factor_arx(record, 4)}).order(), 4);
  EXPECT_NEAR(fit_pooled({factor_arx(record, 4)}).denominator[1],
              least_squares(record, 4).denominator[1], tolerance);
  // Order 4: nine parameters and four samples before the first equation, one equation to spare.
  EXPECT_NO_THROW(least_squares(part(record, 0, 14), 4));
  EXPECT_THROW(least_squares(part(record, 0, 13), 4), ConfigError);
}

TEST(ArxTest, RecordsOfAnotherOrderOrRateAreNotPooled) {
  const Record record = record_of(body_like_model(), white_noise(400, 1.6, 1));
  Record faster = record;
  faster.rate_hz = 2.0 * record.rate_hz;
  const ArxFactor first = factor_arx(record, 4);
  EXPECT_THROW(fit_pooled({}), ConfigError);
  EXPECT_THROW(fit_pooled({first, factor_arx(record, 3)}), ConfigError);
  EXPECT_THROW(fit_pooled({first, factor_arx(faster, 4)}), ConfigError);
  EXPECT_NO_THROW(fit_pooled({first, first}));
}

TEST(ArxTest, UselessRecordsAreRefusedWithTheReason) {
  const auto refusal = [](const Record& record) {
    return support::refusal([&] { fit_arx(record, 4); });
  };
  const auto a = white_noise(1000, 1.0, 7);
  const std::vector<double> constant(1000, 2.0);
  auto broken = a;
  broken[17] = std::nan("");
  EXPECT_NE(refusal({50.0, constant, a}).find("no excitation"), std::string::npos);
  EXPECT_NE(refusal({50.0, a, constant}).find("force is constant"), std::string::npos);
  EXPECT_NE(refusal({50.0, broken, a}).find("acceleration, sample 18"), std::string::npos);
  EXPECT_NE(refusal({50.0, a, {1.0}}).find("force: got 1 samples"), std::string::npos);
  EXPECT_NE(refusal({0.0, a, a}).find("sample rate"), std::string::npos);
  EXPECT_NE(refusal({50.0, {1.0, 2.0}, {1.0, 2.0}}).find("2 samples"), std::string::npos);
}

}  // namespace
}  // namespace stillhand::identification::arx_test
