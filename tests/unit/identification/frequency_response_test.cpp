// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/frequency_response.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/feedthrough_records.hpp"

namespace stillhand::identification::frequency_response_test {
namespace {

TEST(FrequencyResponseTest, GivesDecibelsAndDegrees) {
  // f(n) = -10 a(n-1): 20 dB everywhere; phase 180 degrees less 360 * f / 50.
  const auto sut = frequency_response({50.0, {0.0, -10.0}, {1.0, 0.0}}, {0.0, 5.0, 12.5});
  ASSERT_EQ(sut.size(), 3u);
  for (const auto& point : sut) EXPECT_NEAR(point.magnitude_db, 20.0, 1e-12);
  EXPECT_NEAR(std::abs(sut[0].phase_deg), 180.0, 1e-12);
  EXPECT_NEAR(sut[1].phase_deg, 144.0, 1e-12);
  EXPECT_NEAR(sut[2].phase_deg, 90.0, 1e-12);
  EXPECT_EQ(sut[1].frequency_hz, 5.0);
}

TEST(FrequencyResponseTest, ShowsThePapersShape) {
  // About 10 dB at 0 Hz, a notch between 5 and 8 Hz (paper IV-A).
  const auto frequencies = log_spaced_hz(0.1, 10.0, 200);
  const auto sut = frequency_response(support::body_like_model(), frequencies);
  EXPECT_NEAR(sut.front().magnitude_db, 10.1, 0.1);
  std::size_t notch = 0;
  for (std::size_t i = 0; i < sut.size(); ++i) {
    if (sut[i].magnitude_db < sut[notch].magnitude_db) notch = i;
  }
  EXPECT_GT(sut[notch].frequency_hz, 5.0);
  EXPECT_LT(sut[notch].frequency_hz, 8.0);
}

TEST(FrequencyResponseTest, FrequenciesAreEvenInTheirLogarithm) {
  const auto sut = log_spaced_hz(0.1, 10.0, 5);
  ASSERT_EQ(sut.size(), 5u);
  EXPECT_NEAR(sut[0], 0.1, 1e-15);
  EXPECT_NEAR(sut[2], 1.0, 1e-14);
  EXPECT_NEAR(sut[4], 10.0, 1e-13);
  EXPECT_EQ(log_spaced_hz(1.0, 4.0, 2), (std::vector<double>{1.0, 4.0}));
}

}  // namespace
}  // namespace stillhand::identification::frequency_response_test
