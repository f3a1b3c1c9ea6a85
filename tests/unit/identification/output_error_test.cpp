// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/output_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/identification/arx.hpp"
#include "tests/support/feedthrough_records.hpp"

namespace stillhand::identification::output_error_test {
namespace {

using support::band_noise;
using support::body_like_model;
using support::record_of;
using support::white_noise;

// Largest error of the response in the excited band over the gain at 0 Hz.
double band_error(const DifferenceModel& model) {
  const DifferenceModel truth = body_like_model();
  double worst = 0.0;
  for (double f = 0.7; f <= 4.0; f += 0.1) {
    worst =
        std::max(worst, std::abs(signal::response_at(model, f) - signal::response_at(truth, f)));
  }
  return worst / 3.2;
}

Record noisy_record(std::uint64_t seed, double noise_n) {
  Record record = record_of(body_like_model(), band_noise(6000, 50.0, 0.7, 4.0, 1.6, seed));
  const auto noise = white_noise(record.size(), noise_n, seed + 1000);
  for (std::size_t n = 0; n < noise.size(); ++n) record.force_n[n] += noise[n];
  return record;
}

TEST(OutputErrorTest, IsLessBiasedThanArxUnderOutputNoise) {
  // 0.2 N of white noise on about 5 N of force.  ARX takes it for dynamics: its bias does not
  // average out, that of the free-run fit does.
  DifferenceModel arx_mean{50.0, std::vector<double>(5, 0.0), {}};
  double arx_error = 0.0;
  double sut_error = 0.0;
  constexpr int kRecords = 8;
  for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
    const Record record = noisy_record(seed, 0.2);
    const ArxFit arx = fit_arx(record, 4);
    const OutputErrorFit sut = refine_output_error(record, arx.model);
    arx_error += band_error(arx.model) / kRecords;
    sut_error += band_error(sut.model) / kRecords;
    EXPECT_LE(sut.rms_n, sut.start_rms_n);
    // What is left is the noise: 0.2 N with a relative deviation of 1/sqrt(2 * 5950) = 0.9 %.
    EXPECT_NEAR(sut.rms_n, 0.2, 0.2 * 0.04);
    EXPECT_TRUE(signal::is_stable(sut.model));
  }
  std::printf("response error in band: ARX %.2f %%, output error %.2f %%\n", 100.0 * arx_error,
              100.0 * sut_error);
  EXPECT_LT(sut_error, 0.2 * arx_error);
}

TEST(OutputErrorTest, LeavesAnExactModelAsItIs) {
  const Record record = record_of(body_like_model(), white_noise(2000, 1.6, 3));
  const OutputErrorFit sut = refine_output_error(record, body_like_model());
  EXPECT_EQ(sut.start_rms_n, 0.0);
  EXPECT_EQ(sut.rms_n, 0.0);
  EXPECT_EQ(sut.model.numerator, body_like_model().numerator);
  EXPECT_TRUE(sut.converged);
}

TEST(OutputErrorTest, FindsTheTruthFromAWrongStart) {
  // Every parameter off by 5 %.  Noise-free: the minimum is 0, and Gauss-Newton reaches rounding.
  DifferenceModel start = body_like_model();
  for (double& c : start.numerator) c *= 1.05;
  for (std::size_t j = 1; j < start.denominator.size(); ++j) start.denominator[j] *= 0.95;
  const Record record = record_of(body_like_model(), white_noise(3000, 1.6, 4));
  const OutputErrorFit sut = refine_output_error(record, start);
  EXPECT_TRUE(sut.converged);
  EXPECT_GT(sut.start_rms_n, 0.1);
  // Rounding of a recursion whose noise gain is below 100.
  EXPECT_LT(sut.rms_n, 1e-11);
}

TEST(OutputErrorTest, GradientVanishesAtTheMinimum) {
  // Exact sensitivities: at the minimum no parameter, moved either way, lowers the error.
  const Record record = noisy_record(7, 0.2);
  const OutputErrorFit sut = refine_output_error(record, fit_arx(record, 4).model);
  ASSERT_TRUE(sut.converged);
  const auto cost = [&](const DifferenceModel& model) {
    const auto run = signal::simulated(model, record.acceleration_m_s2);
    double sum = 0.0;
    for (std::size_t n = 50; n < run.size(); ++n) sum += std::pow(record.force_n[n] - run[n], 2);
    return sum;
  };
  const double least = cost(sut.model);
  for (std::size_t i = 0; i <= 4; ++i) {
    for (const double factor : {1.0 - 1e-4, 1.0 + 1e-4}) {
      DifferenceModel moved = sut.model;
      moved.numerator[i] *= factor;
      EXPECT_GT(cost(moved), least) << "c_" << i;
      moved = sut.model;
      if (i == 0) continue;
      moved.denominator[i] *= factor;
      EXPECT_GT(cost(moved), least) << "d_" << i;
    }
  }
}

TEST(OutputErrorTest, AnUnstableStartIsMirroredAndComesOutStable) {
  DifferenceModel start = body_like_model();
  start.denominator = {1.0, -2.2, 1.4, 0.0, 0.0};  // radius 1.18
  ASSERT_FALSE(signal::is_stable(start));
  const Record record = noisy_record(8, 0.1);
  const OutputErrorFit sut = refine_output_error(record, start);
  EXPECT_TRUE(signal::is_stable(sut.model));
  // z^2 - 2.2 z + 1.4 mirrored is 1.4 z^2 - 2.2 z + 1; the first second does not count.
  start.denominator = {1.0, -2.2 / 1.4, 1.0 / 1.4, 0.0, 0.0};
  EXPECT_NEAR(quality(start, record, 50).free_run_rms_n, sut.start_rms_n, 1e-9 * sut.start_rms_n);
  EXPECT_EQ(sut.heldout.samples, 1500u);  // the last quarter of 6000
  EXPECT_LE(sut.rms_n, sut.start_rms_n);
  EXPECT_TRUE(std::isfinite(sut.heldout.free_run_rms_n));
}

TEST(OutputErrorTest, AStartOfAnotherRateIsRefused) {
  DifferenceModel start = body_like_model();
  start.rate_hz = 100.0;
  EXPECT_THROW(refine_output_error(noisy_record(1, 0.1), start), ConfigError);
  EXPECT_THROW(refine_output_error({50.0, {1.0}, {1.0}}, body_like_model()), ConfigError);
}

}  // namespace
}  // namespace stillhand::identification::output_error_test
