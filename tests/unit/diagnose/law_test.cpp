// SPDX-License-Identifier: Apache-2.0
// The panels that show an effect's law, against the law that made the recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/diagnose/page/evidence.hpp"
#include "apps/diagnose/page/figures.hpp"
#include "tests/unit/diagnose/sample_recordings.hpp"

namespace stillhand::diagnose::law_test {

using diagnosis::Body;
using diagnosis::Effect;

constexpr double kNoise_n = 0.2;

Body static_body() { return {{{-3.2}}, {1.0}, 0.0}; }

struct Drawn {
  Drawn(const Body& body, const Effect& effect)
      : made(test::made_with(body, effect, kNoise_n)),
        evidence(made.found, made.measurement),
        sut(law_of(evidence, 0, trace_of(evidence, 0))) {}

  [[nodiscard]] const report::Series& series(std::size_t panel, report::Kind kind) const {
    const auto& all = sut.panels.at(panel).series;
    const auto at = std::ranges::find(all, kind, &report::Series::kind);
    if (at == all.end()) throw std::out_of_range("a series of that kind");
    return *at;
  }

  test::MadeDiagnosis made;
  Evidence evidence;
  Law sut;
};

// The recording was made with these numbers: the line is the law, the band lies around it.
TEST(LawTest, APathIsShownByMagnitudeAndPhase) {
  const Drawn drawn(static_body(),
                    {"coupled_input", "lagged", {"omega"}, {{"lag", "s", 0.2, 0.01, 2.0}}, {2.0}});
  ASSERT_EQ(drawn.sut.panels.size(), 2U);
  const auto& magnitude = drawn.series(0, report::Kind::kLine);
  const auto& phase = drawn.series(1, report::Kind::kLine);
  const auto& band = drawn.series(0, report::Kind::kBand);
  for (std::size_t i = 0; i < magnitude.x.size(); ++i) {
    // The difference equation of the lag against the continuous one: 10 ms by 200 ms.
    const double turn = 2.0 * std::numbers::pi * magnitude.x[i] * 0.2;
    ASSERT_NEAR(magnitude.y[i], 2.0 / std::hypot(1.0, turn), 0.05);
    ASSERT_NEAR(phase.y[i], -std::atan(turn) * 180.0 / std::numbers::pi, 5.0);
    ASSERT_LT(band.y_low[i], magnitude.y[i]);
    ASSERT_GT(band.y_high[i], magnitude.y[i]);
  }
}

TEST(LawTest, AMapIsShownFromEndToEndWithWhatWasMeasured) {
  const Drawn drawn(static_body(),
                    {"output_saturation", "hard", {}, {{"limit", "N", 3.0, 0.1, 10.0}}, {}});
  ASSERT_EQ(drawn.sut.panels.size(), 1U);
  const auto& line = drawn.series(0, report::Kind::kLine);
  EXPECT_LT(line.x.front(), -5.0) << "3.2 N for each of some two deviations";
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    ASSERT_DOUBLE_EQ(line.y[i], std::clamp(line.x[i], -3.0, 3.0));
  }
  EXPECT_FALSE(drawn.series(0, report::Kind::kErrorBars).x.empty());
}

TEST(LawTest, AForceIsShownOverItsChannel) {
  const Drawn drawn(static_body(), {"coulomb_friction",
                                    "smooth sign, beside the body",
                                    {"omega"},
                                    {{"transition_rate", "rad/s", 0.3, 0.01, 2.0}},
                                    {-1.5}});
  ASSERT_EQ(drawn.sut.panels.size(), 1U);
  const auto& line = drawn.series(0, report::Kind::kLine);
  const auto& band = drawn.series(0, report::Kind::kBand);
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    ASSERT_NEAR(line.y[i], -1.5 * std::tanh(line.x[i] / 0.3), 1e-9);
    ASSERT_LE(band.y_low[i], line.y[i]);
  }
}

TEST(LawTest, WhatHasAMemoryIsShownAsALoop) {
  const Drawn drawn(static_body(), {"hysteresis",
                                    "elastic-plastic, beside the body",
                                    {"position of omega"},
                                    {{"threshold", "rad", 0.05, 0.001, 10.0}},
                                    {1.0, 0.0}});
  ASSERT_EQ(drawn.sut.panels.size(), 1U);
  const auto& loop = drawn.series(0, report::Kind::kLine);
  // Both branches, as long as the largest motion lasts, and nothing beyond the yield force.
  EXPECT_EQ(*std::ranges::max_element(loop.y), 1.0);
  EXPECT_EQ(*std::ranges::min_element(loop.y), -1.0);
  EXPECT_FALSE(std::ranges::is_sorted(loop.x));
}

TEST(LawTest, AStopHasNoForceOfItsOwn) {
  const Body mode{{{0.0, -0.0776, 0.0}}, {1.0, -1.78575, 0.81}, 0.0};
  const Drawn drawn(
      mode, {"output_saturation", "stop above", {}, {diagnosis::constant("limit", "N", 3.0)}, {}});
  EXPECT_TRUE(drawn.sut.panels.empty());
}

TEST(LawTest, ASpringInsideTheBodyIsShownInForces) {
  const Body mode{{{0.0, -0.0776, 0.0}}, {1.0, -1.78575, 0.81}, 0.0};
  const Drawn drawn(
      mode,
      {"dead_zone", "play of the output", {}, {{"threshold", "N", 1.0, 0.1, 10.0}}, {0.01, 0.0}});
  ASSERT_EQ(drawn.sut.panels.size(), 1U);
  const auto& line = drawn.series(0, report::Kind::kLine);
  // Within the gap as steep as beyond it level: e_0/A(1) at a whole newton.
  const double end_n = 0.01 / (1.0 - 1.78575 + 0.81);
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    ASSERT_NEAR(line.y[i], end_n * std::clamp(line.x[i], -1.0, 1.0), 1e-9);
  }
}

TEST(LawTest, ADelayAndAGainNeedNoPanelMore) {
  EXPECT_TRUE(
      Drawn(static_body(), {"delay", "of the input", {}, {{"delay", "s", 0.05, 0.0, 1.0}}, {}})
          .sut.panels.empty());
}

}  // namespace stillhand::diagnose::law_test
