// SPDX-License-Identifier: Apache-2.0
// What the figure of an effect shows, for effects at every place in the model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "apps/diagnose/page/evidence.hpp"
#include "apps/diagnose/page/figures.hpp"
#include "tests/unit/diagnose/sample_recordings.hpp"

namespace stillhand::diagnose::figures_effect_test {

using diagnosis::Body;
using diagnosis::Effect;
using test::made_with;
using test::MadeDiagnosis;
using testing::HasSubstr;

const Body kStatic{{{-3.2}}, {1.0}, 0.0, 1.0, 0.0};
// A mode at 2 Hz, radius 0.9: gain at 0 Hz -3.2.
const Body kMode{{{0.0, -0.0776, 0.0}}, {1.0, -1.78575, 0.81}, 0.0, 1.0, 0.0};
constexpr double kNoise_n = 0.2;

const report::Series& series(const report::Panel& panel, const std::string& label) {
  const auto at = std::ranges::find(panel.series, label, &report::Series::label);
  if (at == panel.series.end()) throw std::out_of_range(label);
  return *at;
}

struct Shown {
  explicit Shown(const MadeDiagnosis& made)
      : evidence(made.found, made.measurement),
        trace(trace_of(evidence, 0)),
        explanation(explanation_of(evidence, 0, trace)) {}

  Evidence evidence;
  EffectTrace trace;
  Explanation explanation;
};

// Share of a series' points that lie within `errors` standard errors of what `truth` says.
template <typename Truth>
double share_within(const report::Series& bars, double errors, const Truth& truth) {
  double within = 0.0;
  for (std::size_t i = 0; i < bars.x.size(); ++i) {
    const double error = bars.y_high[i] - bars.y[i];
    if (std::abs(bars.y[i] - truth(bars.x[i])) <= errors * error) within += 1.0;
  }
  return within / static_cast<double>(bars.x.size());
}

TEST(ExplanationTest, ADelayIsALagThatStays) {
  const Shown sut(made_with(
      kStatic, {"delay", "of the input", {}, {{"delay", "s", 0.05, 0, 1}}, {}}, kNoise_n));
  const auto& lags = series(sut.explanation.panel, "output after prediction");
  ASSERT_GE(lags.x.size(), 10U);
  // Normal deviates: 99.7 % within three; a parabola through a correlation's peak adds a little.
  EXPECT_GE(share_within(lags, 3.0, [](double) { return 50.0; }), 0.9);
}

TEST(ExplanationTest, AChangeOfGainIsSeenOnBothSides) {
  const Shown sut(made_with(kStatic,
                            {"regime_change",
                             "step of the gain",
                             {},
                             {{"time", "s", 30.0, 0.0, 60.0, false}, {"change", "-", 0.2, -5, 5}},
                             {}},
                            kNoise_n));
  const auto& gain = series(sut.explanation.panel, "measured over predicted");
  ASSERT_GE(gain.x.size(), 8U);
  // All but the one bin that holds the step.
  EXPECT_GE(share_within(gain, 4.0, [](double t_s) { return t_s < 30.0 ? 0.8 : 1.2; }),
            1.0 - 1.5 / static_cast<double>(gain.x.size()));
}

TEST(ExplanationTest, AnOutputMapIsShownOverThePredictionWithoutIt) {
  const Shown sut(made_with(
      kStatic, {"output_saturation", "hard", {}, {{"limit", "N", 4.0, 0.1, 100.0}}, {}}, kNoise_n));
  EXPECT_THAT(sut.explanation.panel.x.label, HasSubstr("prediction without it"));
  const auto& bars = series(sut.explanation.panel, "without it");
  // Bins that don't hold the corner, where the mean over a bin is rounded off.
  EXPECT_GE(share_within(bars, 4.0, [](double y) { return std::clamp(y, -4.0, 4.0) - y; }),
            1.0 - 2.5 / static_cast<double>(bars.x.size()));
}

TEST(ExplanationTest, ARippleIsShownOverOnePeriodOfItsPosition) {
  const Shown sut(made_with(kStatic,
                            {"position_ripple",
                             "one harmonic",
                             {"position of omega"},
                             {{"spatial_frequency", "1/rad", 4.0, 3.0, 5.0}},
                             {1.0, 0.0}},
                            kNoise_n));
  EXPECT_THAT(sut.explanation.panel.x.label, HasSubstr("within a period of 0.25 rad"));
  const auto& bars = series(sut.explanation.panel, "without it");
  // A thirtieth of a period flattens a sine by (pi/30)^2/6 = 0.2 %, well below an error bar.
  EXPECT_GE(share_within(bars, 4.0, [](double x) { return std::sin(2.0 * M_PI * 4.0 * x); }), 0.9);
}

// A shape without a law is shown as it was fitted: a force that no channel's sign or power gives.
TEST(ExplanationTest, AFreeFormIsItsCurveWithABand) {
  Effect curve{"free_form", "force over a channel", {"omega"}, {}, {0.5, -0.4}};
  const double knots[] = {-1.0, 0.0, 1.0};
  for (int k = 0; k < 3; ++k) {
    curve.parameters.push_back(
        {"knot_" + std::to_string(k + 1), "rad/s", knots[k], knots[k], knots[k], false});
  }
  const Shown sut(made_with(kStatic, curve, kNoise_n));
  const report::Panel& panel = sut.explanation.panel;
  EXPECT_EQ(panel.x.label, "omega [rad/s]");
  EXPECT_EQ(panel.y.label, "force [N]");
  EXPECT_THAT(series(panel, "the effect").x, testing::ElementsAre(-1.0, 0.0, 1.0));
  EXPECT_THAT(series(panel, "the effect").y, testing::ElementsAre(0.5, 0.0, -0.4));
  const report::Series& band = series(panel, "95 %");
  EXPECT_EQ(band.y_low[1], 0.0) << "the curve is counted from there";
  // 0.2 N of noise: no better than all 6000 samples allow, no worse than a twentieth of them.
  EXPECT_GT(band.y_high[0] - band.y_low[0], 2 * 1.96 * 0.2 / std::sqrt(6000.0));
  EXPECT_LT(band.y_high[0] - band.y_low[0], 2 * 1.96 * 0.2 / std::sqrt(300.0));
  EXPECT_GE(share_within(series(panel, "without it"), 4.0,
                         [](double x) {
                           const double held = std::clamp(x, -1.0, 1.0);
                           return held < 0.0 ? -0.5 * held : -0.4 * held;
                         }),
            0.9);
}

TEST(ExplanationTest, ALagIsFoundByTheTimeThatTellsMost) {
  // A low-pass of 0.2 s delays by 200 ms at 0 Hz and by atan(0.4 pi)/(2 pi) = 143 ms at 1 Hz, where
  // omega ends: of the lags that are tried 130 and 200 ms are next to that.
  const Shown sut(made_with(
      kStatic, {"coupled_input", "lagged", {"omega"}, {{"lag", "s", 0.2, 0.01, 2.0}}, {2.0}},
      kNoise_n));
  EXPECT_THAT(sut.explanation.panel.x.label,
              testing::AnyOf("omega 130 ms earlier [rad/s]", "omega 200 ms earlier [rad/s]"));
}

TEST(ExplanationTest, WhatDependsOnItsPastIsShownByDirection) {
  const Shown sut(made_with(kStatic,
                            {"hysteresis",
                             "elastic-plastic, beside the body",
                             {"position of omega"},
                             {{"threshold", "rad", 0.05, 0.001, 10.0}},
                             {1.0, 0.0}},
                            kNoise_n));
  const auto& rising = series(sut.explanation.panel, "rising");
  const auto& falling = series(sut.explanation.panel, "falling");
  ASSERT_GE(rising.x.size(), 5U);
  ASSERT_GE(falling.x.size(), 5U);
  // It yields after 0.1 rad of some 4 rad: +1 where it rises and -1 where it falls, but for the
  // positions that are hardly reached but to turn there.
  EXPECT_GT(std::ranges::count_if(rising.y, [](double y) { return y > 0.5; }),
            static_cast<std::ptrdiff_t>(rising.y.size() / 2));
  EXPECT_GT(std::ranges::count_if(falling.y, [](double y) { return y < -0.5; }),
            static_cast<std::ptrdiff_t>(falling.y.size() / 2));
}

TEST(ExplanationTest, WhatSitsInALoopIsTakenOutByANewFit) {
  const Shown sut(made_with(kMode,
                            {"hysteresis",
                             "elastic-plastic of the output",
                             {},
                             {{"threshold", "N", 1.0, 0.1, 10.0}},
                             {-0.1, 0.0}},
                            0.02));
  EXPECT_TRUE(sut.trace.refitted);
  EXPECT_THAT(sut.explanation.panel.x.label, HasSubstr("the body's output"));
  EXPECT_FALSE(sut.explanation.panel.series.back().x.empty());
}

TEST(ExplanationTest, ABurstIsShownWithItsEnds) {
  MadeDiagnosis made =
      made_with(kStatic,
                {"transients",
                 "isolated bursts",
                 {},
                 {{"begin_1", "s", 20.0, 0, 60, false}, {"end_1", "s", 20.5, 0, 60, false}},
                 {}},
                kNoise_n);
  for (std::size_t n = 2010; n < 2040; ++n) made.measurement.channels[2].values[n] += 10.0;
  const Shown sut(made);
  ASSERT_EQ(sut.explanation.panel.reference_lines.size(), 2U);
  EXPECT_NEAR(sut.explanation.panel.reference_lines[0].at, 20.0, 1.5 / test::kRate_hz);
  EXPECT_NEAR(sut.explanation.panel.reference_lines[1].at, 20.5, 1.5 / test::kRate_hz);
  const auto& line = series(sut.explanation.panel, "residual");
  EXPECT_GT(*std::ranges::max_element(line.y), 9.0);
}

TEST(ExplanationTest, AFurtherModeIsShownAsAResponse) {
  // Poles of a mode at 3 Hz, radius 0.97; its filter's gain at resonance is about 180.
  const Shown sut(
      made_with(kStatic,
                {"resonance",
                 "beside the body",
                 {},
                 {{"frequency", "Hz", 3.0, 0.1, 40.0}, {"damping_ratio", "-", 0.15, 0.003, 0.95}},
                 {0.0, 0.05}},
                kNoise_n));
  EXPECT_THAT(sut.explanation.panel.y.label, HasSubstr("response to a_y [N/(m/s²)]"));
  const auto& response = series(sut.explanation.panel, "the effect");
  const auto peak = std::ranges::max_element(response.y) - response.y.begin();
  // Lines of 256 samples: 0.39 Hz apart.
  EXPECT_NEAR(response.x[static_cast<std::size_t>(peak)], 3.0, 0.8);
}

TEST(FigureEffectTest, TheEffectsOwnPredictionHasSlopeOne) {
  const MadeDiagnosis made =
      made_with(kStatic, {"coupled_input", "static", {"omega"}, {}, {0.5}}, kNoise_n);
  const report::Figure sut = figure_effect(Evidence(made.found, made.measurement), 0);
  ASSERT_EQ(sut.panels.size(), 4U);
  const auto& bars = series(sut.panels[1], "without it");
  ASSERT_GE(bars.x.size(), 8U);
  EXPECT_GE(share_within(bars, 4.0, [](double x) { return x; }), 0.9);
}

// The model that doesn't pass over the burst has another initial state, so that the two differ a
// little where they count: nothing that the bursts would predict.
TEST(FigureEffectTest, ABurstPredictsNothingOfWhatCounts) {
  MadeDiagnosis made =
      made_with(kMode,
                {"transients",
                 "isolated bursts",
                 {},
                 {{"begin_1", "s", 1.1, 0, 60, false}, {"end_1", "s", 1.5, 0, 60, false}},
                 {}},
                kNoise_n);
  for (std::size_t n = 110; n < 150; ++n) made.measurement.channels[2].values[n] += 10.0;
  const report::Figure sut = figure_effect(Evidence(made.found, made.measurement), 0);
  EXPECT_EQ(sut.panels.size(), 1U);
}

}  // namespace stillhand::diagnose::figures_effect_test
