// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

// The free run against difference equations that are written out here, stage by stage of the model
// (services/core/diagnosis/RESULTS.md); two stretches, so that nothing leaks from one into the
// other.
namespace stillhand::diagnosis::free_run_test {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;

constexpr std::size_t kCount = 121;
constexpr std::size_t kCut = 70;
constexpr double kPause_s = 3.0;
// Sums of a few terms near 1, 70 samples of a body that forgets within 30: 1e-16 times a few
// hundred.
constexpr double kRounding = 1e-13;

// They swing about 0, so that every stretch starts from rest (Eq. DG-54).
const std::vector<double> kU = made::white(kCount, 1);
const std::vector<double> kV = made::white(kCount, 2);
const Body kBody = made::two_pole_body();
const std::vector<double>& kB = kBody.numerators.front();
const std::vector<double>& kA = kBody.denominator;
constexpr double kOffset = 0.7;

Signals signals_of() {
  Measurement measurement =
      made::measurement_of({{"u", "V", kU}, {"v", "V", kV}, {"y", "N", made::white(kCount, 3)}});
  return {made::cut_in_two(std::move(measurement), kCut, kPause_s), {"u"}, "y"};
}

FreeRun run_of(std::vector<Effect> effects, bool with_time_only = true) {
  Model model = made::model_of(kBody, std::move(effects));
  model.body.offset = kOffset;
  return free_run(model, signals_of(), with_time_only);
}

// x(n - i) within the stretch of n, 0 before it.
double past(const std::vector<double>& x, std::size_t n, std::size_t i) {
  const std::size_t first = n < kCut ? 0 : kCut;
  return n - first >= i ? x[n - i] : 0.0;
}

// sum_i c_i x(n - i)
double sum_of(const std::vector<double>& c, const std::vector<double>& x, std::size_t n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) sum += c[i] * past(x, n, i);
  return sum;
}

// y = (B u + force) / A
std::vector<double> body_by_hand(const std::vector<double>& u,
                                 const std::vector<double>& force = {}) {
  std::vector<double> y(kCount, 0.0);
  for (std::size_t n = 0; n < kCount; ++n) {
    y[n] = sum_of(kB, u, n) - kA[1] * past(y, n, 1) - kA[2] * past(y, n, 2) +
           (force.empty() ? 0.0 : force[n]);
  }
  return y;
}

std::vector<double> with_offset(std::vector<double> y) {
  for (double& value : y) value += kOffset;
  return y;
}

double time_s(std::size_t n) {
  return static_cast<double>(n) / made::kRateHz + (n < kCut ? 0.0 : kPause_s);
}
double length_s() { return time_s(kCount - 1); }

Effect mapped(const char* kind, const char* form, std::vector<std::string> channels, double value) {
  return {kind, form, std::move(channels), {{"value", "-", value, -10.0, 10.0}}, {}};
}

TEST(FreeRunTest, TheBodyIsItsDifferenceEquation) {
  const FreeRun sut = run_of({});
  EXPECT_TRUE(sut.finite);
  EXPECT_THAT(sut.body, Pointwise(DoubleNear(kRounding), body_by_hand(kU)));
  EXPECT_THAT(sut.prediction, Pointwise(DoubleNear(kRounding), with_offset(body_by_hand(kU))));
  EXPECT_THAT(sut.output_slope, Pointwise(DoubleNear(0.0), std::vector<double>(kCount, 1.0)));
}

TEST(FreeRunTest, TwoInputsShareTheDenominator) {
  const Signals signals(made::measurement_of({{"u", "V", kU}, {"v", "V", kV}, {"y", "N", kU}}),
                        {"v", "u"}, "y");
  Model model = made::model_of(kBody);
  model.inputs = {"v", "u"};
  model.body.numerators = {{0.3, 0.2, 0.1}, kB};
  std::vector<double> want = made::answer({0.3, 0.2, 0.1}, kA, kV);
  const auto other = made::answer(kB, kA, kU);
  for (std::size_t n = 0; n < kCount; ++n) want[n] += other[n];
  EXPECT_THAT(free_run(model, signals).prediction, Pointwise(DoubleNear(kRounding), want));
}

TEST(FreeRunTest, AStaticBodyHasNoPast) {
  Model model = made::model_of({{{2.0}}, {1.0}, kOffset});
  std::vector<double> want = kU;
  for (double& value : want) value = 2.0 * value + kOffset;
  EXPECT_THAT(free_run(model, signals_of()).prediction, Pointwise(DoubleNear(kRounding), want));
}

// Stage 1, Eq. DG-2.  25 samples; what was before a stretch is taken as its first value.
TEST(FreeRunTest, ADelayComesBeforeTheBody) {
  std::vector<double> late(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    const std::size_t first = n < kCut ? 0 : kCut;
    late[n] = kU[n - first >= 25 ? n - 25 : first];
  }
  const FreeRun sut = run_of({mapped("delay", "of the input", {}, 0.25)});
  EXPECT_THAT(sut.body, Pointwise(DoubleNear(kRounding), body_by_hand(late)));
}

// Stage 2, Eq. DG-3.
TEST(FreeRunTest, AMapOfTheInputComesBeforeTheBody) {
  const auto want_for = [](const std::function<double(double)>& map) {
    std::vector<double> u = kU;
    std::ranges::transform(u, u.begin(), map);
    return body_by_hand(u);
  };
  EXPECT_THAT(run_of({mapped("input_saturation", "hard", {"u"}, 0.8)}).body,
              Pointwise(DoubleNear(kRounding),
                        want_for([](double u) { return std::clamp(u, -0.8, 0.8); })));
  EXPECT_THAT(run_of({mapped("input_saturation", "soft", {"u"}, 0.8)}).body,
              Pointwise(DoubleNear(kRounding),
                        want_for([](double u) { return 0.8 * std::tanh(u / 0.8); })));
}

// Stage 3, Eq. DG-4: A y = B u + q^-1 (e_0 + e_1 D) phi(y), phi the cube of y in thresholds.
TEST(FreeRunTest, AFeedbackOfTheOutputIsInsideTheRecursion) {
  const double threshold = 2.0;
  const double e0 = -0.2;
  const double e1 = 0.1;
  std::vector<double> y(kCount, 0.0);
  std::vector<double> phi(kCount, 0.0);
  for (std::size_t n = 0; n < kCount; ++n) {
    y[n] = sum_of(kB, kU, n) - kA[1] * past(y, n, 1) - kA[2] * past(y, n, 2) +
           e0 * past(phi, n, 1) + e1 * (past(phi, n, 1) - past(phi, n, 2));
    phi[n] = std::pow(y[n] / threshold, 3);
  }
  const FreeRun sut =
      run_of({made::effect_of("nonlinear_stiffness", "cubic of the output", {},
                              {{"threshold", "N", threshold, 0.1, 10.0}}, {e0, e1})});
  EXPECT_THAT(sut.body, Pointwise(DoubleNear(kRounding), y));
  EXPECT_THAT(sut.prediction, Pointwise(DoubleNear(kRounding), with_offset(y)));
}

// A z = N u + M phi(z), A y = B u + E phi(z); E = e_0 + e_1 D + e_2 D^2, N alike,
// M = q^-1 (m_0 + m_1 D); phi clips at 1: play.
TEST(FreeRunTest, AFeedbackInsideTheBodyHasADisplacementOfItsOwn) {
  const std::vector<double> coefficients{0.3, -0.2, 0.1, 0.8, 0.4, -0.3, -0.15, 0.05};
  const double* e = coefficients.data();
  const double* n_path = e + 3;
  const double* m = e + 6;
  std::vector<double> y(kCount, 0.0);
  std::vector<double> z(kCount, 0.0);
  std::vector<double> phi(kCount, 0.0);
  // sum_i c_i D^i x at n, three terms.
  const auto differences = [](const double* c, const std::vector<double>& x, std::size_t n) {
    const double x0 = past(x, n, 0);
    const double x1 = past(x, n, 1);
    const double x2 = past(x, n, 2);
    return c[0] * x0 + c[1] * (x0 - x1) + c[2] * (x0 - 2.0 * x1 + x2);
  };
  bool clips = false;
  for (std::size_t n = 0; n < kCount; ++n) {
    z[n] = differences(n_path, kU, n) + m[0] * past(phi, n, 1) +
           m[1] * (past(phi, n, 1) - past(phi, n, 2)) - kA[1] * past(z, n, 1) -
           kA[2] * past(z, n, 2);
    phi[n] = std::clamp(z[n], -1.0, 1.0);
    clips = clips || phi[n] != z[n];
    y[n] =
        sum_of(kB, kU, n) + differences(e, phi, n) - kA[1] * past(y, n, 1) - kA[2] * past(y, n, 2);
  }
  EXPECT_TRUE(clips);
  const FreeRun sut = run_of({{"dead_zone", "play inside the body", {}, {}, coefficients}});
  EXPECT_THAT(sut.body, Pointwise(DoubleNear(kRounding), y));
}

// Elastic up to a change of 1, then plastic: w follows z and never leaves [-1, 1].
TEST(FreeRunTest, AHystereticFeedbackRemembersWithinAStretchAlone) {
  const double threshold = 0.5;
  const double e0 = -0.3;
  std::vector<double> y(kCount, 0.0);
  std::vector<double> w(kCount, 0.0);
  for (std::size_t n = 0; n < kCount; ++n) {
    y[n] = sum_of(kB, kU, n) - kA[1] * past(y, n, 1) - kA[2] * past(y, n, 2) + e0 * past(w, n, 1);
    const bool begins = n == 0 || n == kCut;
    w[n] = begins ? 0.0 : std::clamp(w[n - 1] + (y[n] - y[n - 1]) / threshold, -1.0, 1.0);
  }
  const FreeRun sut =
      run_of({made::effect_of("hysteresis", "elastic-plastic of the output", {},
                              {{"threshold", "N", threshold, 0.1, 10.0}}, {e0, 0.0})});
  EXPECT_THAT(sut.body, Pointwise(DoubleNear(kRounding), y));
}

// Stage 4, Eq. DG-5: the body's output alone is multiplied, not the offset.
TEST(FreeRunTest, AGainMultipliesTheBodysOutput) {
  const auto y = body_by_hand(kU);
  std::vector<double> by_time(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    by_time[n] = kOffset + (1.0 + 0.4 * (2.0 * time_s(n) / length_s() - 1.0)) * y[n];
  }
  const FreeRun sut = run_of({mapped("time_varying_gain", "linear", {}, 0.4)});
  EXPECT_THAT(sut.body, Pointwise(DoubleNear(kRounding), y));
  EXPECT_THAT(sut.prediction, Pointwise(DoubleNear(kRounding), by_time));
}

// Stage 5, Eq. DG-6.
TEST(FreeRunTest, TermsAreAddedBesideTheBodyOrThroughItsPoles) {
  const auto y = body_by_hand(kU);
  std::vector<double> beside(kCount);
  std::vector<double> force(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    beside[n] = kOffset + y[n] + 1.5 * kV[n];
    // (c_0 + c_1 D + c_2 D^2) v before the poles.
    force[n] = 0.5 * past(kV, n, 0) + 0.2 * (past(kV, n, 0) - past(kV, n, 1)) -
               0.1 * (past(kV, n, 0) - 2.0 * past(kV, n, 1) + past(kV, n, 2));
  }
  EXPECT_THAT(run_of({{"coupled_input", "static", {"v"}, {}, {1.5}}}).prediction,
              Pointwise(DoubleNear(kRounding), beside));
  EXPECT_THAT(
      run_of({{"coupled_input", "through the body", {"v"}, {}, {0.5, 0.2, -0.1}}}).prediction,
      Pointwise(DoubleNear(kRounding), with_offset(body_by_hand(kU, force))));
}

// Stage 6, Eq. DG-7: offset, gain and terms are inside the map.
TEST(FreeRunTest, AMapOfTheOutputComesLast) {
  const auto y = with_offset(body_by_hand(kU));
  std::vector<double> clipped = y;
  std::vector<double> slope(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    clipped[n] = std::clamp(y[n] + 1.5 * kV[n], -1.0, 1.0);
    slope[n] = clipped[n] == y[n] + 1.5 * kV[n] ? 1.0 : 0.0;
  }
  const FreeRun sut = run_of({mapped("output_saturation", "hard", {}, 1.0),
                              {"coupled_input", "static", {"v"}, {}, {1.5}}});
  EXPECT_THAT(sut.prediction, Pointwise(DoubleNear(kRounding), clipped));
  EXPECT_THAT(sut.output_slope, Pointwise(DoubleNear(0.0), slope));
  EXPECT_THAT(sut.body, Pointwise(DoubleNear(kRounding), body_by_hand(kU)));
  std::vector<double> cubic = y;
  for (double& value : cubic) value += 0.05 * value * value * value;
  EXPECT_THAT(run_of({mapped("nonlinear_stiffness", "at the output", {}, 0.05)}).prediction,
              Pointwise(DoubleNear(1e-12), cubic));
}

TEST(FreeRunTest, AllStagesTogetherFollowTheSignalsWay) {
  std::vector<double> u(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    const std::size_t first = n < kCut ? 0 : kCut;
    u[n] = std::clamp(kU[n - first >= 25 ? n - 25 : first], -1.0, 1.0);
  }
  std::vector<double> want = body_by_hand(u);
  for (std::size_t n = 0; n < kCount; ++n) {
    want[n] = kOffset + (time_s(n) < 0.5 ? 0.8 : 1.2) * want[n] + 0.4 * kV[n];
    want[n] = 0.9 * std::tanh(want[n] / 0.9);
  }
  // Listed against the signal's way.
  const FreeRun sut = run_of(
      {mapped("output_saturation", "soft", {}, 0.9),
       {"coupled_input", "static", {"v"}, {}, {0.4}},
       made::effect_of("regime_change", "step of the gain", {},
                       {{"time", "s", 0.5, 0.0, 9.0, false}, {"change", "-", 0.2, -5.0, 5.0}}),
       mapped("delay", "of the input", {}, 0.25),
       mapped("input_saturation", "hard", {"u"}, 1.0)});
  EXPECT_THAT(sut.prediction, Pointwise(DoubleNear(kRounding), want));
}

TEST(FreeRunTest, WhatIsNotClaimedWeighsNothing) {
  const FreeRun sut = run_of({made::effect_of(
      "transients", "isolated bursts", {},
      {{"begin_1", "s", 0.3, 0.0, 9.0, false}, {"end_1", "s", 0.5, 0.0, 9.0, false}})});
  for (std::size_t n = 0; n < kCount; ++n) {
    // A tenth of each stretch, 7 and 5 samples, isn't judged; 0.3 s is sample 30.
    const bool early = n < 7 || (n >= kCut && n < kCut + 5);
    const bool burst = n >= 30 && n < 50;
    EXPECT_EQ(sut.weight[n], early || burst ? 0.0 : 1.0) << n;
  }
  EXPECT_THAT(sut.prediction, Pointwise(DoubleNear(kRounding), with_offset(body_by_hand(kU))));
}

TEST(FreeRunTest, WhatNoInputCanTellIsLeftOutOnRequest) {
  const std::vector<Effect> effects{
      {"drift", "linear", {}, {}, {5.0}},
      mapped("time_varying_gain", "linear", {}, 0.4),
      {"tone", "beside the body", {}, {{"frequency", "Hz", 3.0, 2.0, 4.0}}, {1.0, 1.0}},
      {"coupled_input", "static", {"v"}, {}, {1.5}}};
  std::vector<double> want = with_offset(body_by_hand(kU));
  for (std::size_t n = 0; n < kCount; ++n) want[n] += 1.5 * kV[n];
  EXPECT_THAT(run_of(effects, false).prediction, Pointwise(DoubleNear(kRounding), want));
  EXPECT_GT(std::abs(run_of(effects).prediction[10] - want[10]), 0.1);
}

TEST(FreeRunTest, ABodyThatIsUnstableOrALoopThatRunsAwayIsToldSo) {
  Model unstable = made::model_of(kBody);
  unstable.body.denominator = {1.0, -2.1, 1.1};
  EXPECT_FALSE(free_run(unstable, signals_of()).finite);
  // A cube with positive feedback beyond its unstable point.
  EXPECT_FALSE(run_of({made::effect_of("nonlinear_stiffness", "cubic of the output", {},
                                       {{"threshold", "N", 0.1, 0.01, 10.0}}, {2.0, 0.0})})
                   .finite);
}

}  // namespace stillhand::diagnosis::free_run_test
