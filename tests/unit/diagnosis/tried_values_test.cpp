// SPDX-License-Identifier: Apache-2.0
// The values that a kind tries, METHOD "Kinds".  Next to the true body and without noise one that
// is the truth leaves nothing, so it is the one that is proposed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::tried_values_test {

constexpr std::size_t kCount = 2001;  // 20 s

Signals signals_of(std::vector<double> y, double rate_hz = made::kRateHz) {
  const std::size_t count = y.size();
  std::vector<double> swept(count);  // to and fro within 2 rad, 1 rad/s
  for (std::size_t n = 0; n < count; ++n) {
    swept[n] = 0.01 * std::abs(static_cast<double>(n % 400) - 200.0);
  }
  // Deviations of 2 and 0.5: by 1 a bound that is divided by it is one that is multiplied.
  return {
      made::measurement_of({{"u", "V", made::scaled_to(made::ride(count, 1), 2.0)},
                            {"theta", "rad", made::scaled_to(made::ride(count, 2, 0.1, 1.0), 0.5)},
                            {"temp", "degC", made::ride(count, 3, 0.1, 1.0)},
                            {"swept", "rad", swept},
                            {"y", "N", std::move(y)}},
                           rate_hz),
      {"u"},
      "y"};
}

// Of the kind, next to the body and a path that does nothing: with another effect in the model no
// kind estimates bodies of its own.
std::vector<Proposal> proposed(const std::string& kind, const Signals& signals, const Body& body) {
  Model model = made::model_of(body);
  if (body.order() > 1) {
    model.effects = {{"coupled_input", "through the body", {"temp"}, {}, {0.0, 0.0, 0.0}}};
  }
  const Blocks blocks = make_blocks(signals);
  const ImpulseResponse none;
  return effect_kind(kind).proposed(Screening(model, signals, blocks, none));
}

Signals output_of(const Effect& truth, const Body& body = made::two_pole_body(),
                  std::size_t count = kCount, double rate_hz = made::kRateHz) {
  Model model = made::model_of(body, {truth});
  model.rate_hz = rate_hz;
  return signals_of(free_run(model, signals_of(made::white(count, 4), rate_hz)).prediction,
                    rate_hz);
}

struct Tried {
  Effect truth;  ///< with the bounds that are wanted
  double unit = 1.0;
  std::vector<double> values = {};  ///< [units] of the first number; none: as it is
  double rate_hz = made::kRateHz;
};

std::vector<Tried> all_tried() {
  const Signals signals = signals_of(made::white(kCount, 4));
  const auto deviation = [&](const char* name) { return signals.at(name).deviation; };
  const double u = deviation("u");
  const double theta = deviation("theta");
  const double rate = deviation("rate of theta");
  const double y = deviation_of(free_run(made::model_of(made::two_pole_body()), signals).body);
  const double limit = 0.3 / (y * y);
  double largest = 0.0;
  for (const double value : signals.at("u").values) largest = std::max(largest, std::abs(value));
  const auto change = [](const char* name, double value, double most = 3.0) {
    return Parameter{name, "-", value, -most, most};
  };
  const auto mean = [&](const char* name, const char* of) {
    return constant(name, "", signals.at(of).mean);
  };
  const auto of = [](const char* kind, const char* form, std::vector<std::string> channels,
                     std::vector<Parameter> numbers, std::vector<double> factors = {}) {
    return made::effect_of(kind, form, std::move(channels), std::move(numbers), std::move(factors));
  };
  const std::vector<double> limits{0.3, 0.5, 0.7, 0.9, 1.1, 1.4, 1.7, 2.0, 2.5};
  const std::vector<double> widths{0.1, 0.2, 0.4, 0.8};
  std::vector<Tried> all{
      {of("input_saturation", "hard", {"u"}, {{"", "", 0, 0.02 * u, largest}}), u, limits},
      {of("input_saturation", "soft", {"u"}, {{"", "", 0, 0.02 * u, 5 * largest}}), u, limits},
      {of("dead_zone", "at the input", {"u"}, {{"", "", 0, 0, 3 * u}}), u, widths},
      {of("dead_zone", "beside the body", {"theta"},
          {{"", "", 0, 0, 3 * theta}, mean("centre", "theta")}, {0.5}),
       theta, widths},
      // 100 s: the lag may be doubled from 0.05 s up to a fifth of it, 12.8 s.
      {of("coupled_input", "lagged", {"theta"}, {{"", "", 0, 0.025, 12.8}}, {0.5}),
       1.0,
       {0.05, 0.2, 0.8, 3.0, 10.0},
       20.0},
      {of("coupled_input", "static", {"theta"}, {}, {0.2})},
      {of("coupled_input", "static with rate", {"theta", "rate of theta"}, {}, {0.2, 0.1})},
      {of("coupled_input", "through the body", {"theta"}, {}, {0.3, -0.1, 0.1})},
      {of("coulomb_friction", "sign, beside the body", {"rate of theta"}, {}, {-0.2})},
      {of("coulomb_friction", "sign, through the body", {"rate of theta"}, {}, {-0.2, 0.1, 0.1})},
      {of("coulomb_friction", "smooth sign, beside the body", {"rate of theta"},
          {{"", "", 0.15 * rate, 1e-3 * rate, 0.6 * rate}}, {-0.2})},
      {of("bilinear", "gain of the body", {"temp"},
          {change("", 0.2, 10.0 / deviation("temp")), mean("centre", "temp")})},
      {of("bilinear", "beside the body", {"theta", "temp"},
          {mean("centre_1", "theta"), mean("centre_2", "temp")}, {0.2})},
      {of("bilinear", "through the body", {"u", "theta"},
          {mean("centre_1", "u"), mean("centre_2", "theta")}, {0.2, -0.1, 0.1})},
      {of("asymmetry", "square, beside the body", {"theta"}, {mean("centre", "theta")}, {0.1})},
      // No threshold changes |z| or z^2 but by a factor: it is given.
      {of("asymmetry", "slopes of the output", {}, {constant("", "", y)}, {-1e-4, 0.0})},
      {of("asymmetry", "square of the output", {}, {constant("", "", y)}, {-1e-4, 0.0})},
      {of("asymmetry", "slopes at the input", {"u"}, {change("", 0.15, 0.9)})},
      {of("asymmetry", "slopes at the output", {}, {change("", 0.15, 0.9)})},
      {of("nonlinear_stiffness", "at the output", {}, {change("", 0.1 * limit, limit)})},
      {of("nonlinear_stiffness", "cubic, beside the body", {"theta"}, {mean("centre", "theta")},
          {0.1, 0.05})},
      {of("nonlinear_stiffness", "bent of the output", {}, {{"threshold", ""}}, {-1e-4, 0.0}),
       y,
       {0.5, 1.0, 1.7, 3.0}},
      {of("drift", "linear", {}, {}, {0.3})},
      {of("drift", "slow cosines", {}, {}, {0.2, -0.1, 0.1})},
      {of("drift", "exponential", {}, {{"", "", 0, 0.2, 40.0}}, {0.5}), 20.0, {0.1, 0.25, 0.5}},
      {of("time_varying_gain", "linear", {}, {change("", 0.2)})},
      {of("time_varying_gain", "slow cosines", {},
          {change("", 0.15), change("", 0.02), change("", -0.1), change("", 0.05)})},
      {of("time_varying_gain", "sinusoidal", {},
          {{"", "", 0, 0.5, 12.0}, change("", 0.2), change("", 0.1)}),
       1.0,
       {1.0, 1.5, 2.0, 3.0, 4.0, 6.0}},
      // 0.24 s over the record each way at most, in us/s.
      {of("clock_drift", "of the output", {},
          {{"", "", 0, -2e4, 2e4}, constant("reference_time", "s", 10.0)}),
       1e6 / 20.0,
       {-0.24, -0.12, -0.06, -0.03, 0.03, 0.06, 0.12, 0.24}},
      // 41 moments between 0.05 and 0.95 of the record, here 7 twentieths of a step further.
      {of("regime_change", "step of the gain", {}, {{"", "", 0, 0, 20.0}, change("", 0.25, 5.0)}),
       20.0,
       {0.05 + 2.35 * 0.0225, 0.05 + 16.35 * 0.0225, 0.95 - 0.35 * 0.0225}}};
  for (const char* form : {"elastic-plastic, beside the body", "smooth, beside the body"}) {
    all.push_back(
        {of("hysteresis", form, {"theta"}, {{"", "", 0, 1e-3 * theta, 5 * theta}}, {0.3, 0.1}),
         theta,
         {0.2, 0.5, 1.0}});
  }
  // From 0.3 Hz in steps of two damping ratios to some 8 Hz.
  for (const auto& [damping, steps] : {std::pair{0.012, 138}, {0.035, 48}, {0.1, 18}, {0.3, 7}}) {
    all.push_back({of("resonance", "beside the body", {},
                      {{"", "", 0, 0.15, 40.0}, {"", "", damping, 0.003, 0.95}}, {0.2, -0.1}),
                   0.3,
                   {std::pow(1.0 + 2.0 * damping, steps)}});
  }
  return all;
}

void expect_proposed_as_it_is(const Effect& truth, double rate_hz, double within) {
  SCOPED_TRACE(truth.kind + ", " + truth.form);
  const Signals signals = output_of(truth, made::two_pole_body(), kCount, rate_hz);
  const auto proposals = proposed(truth.kind, signals, made::two_pole_body());
  const auto sut = std::ranges::find_if(
      proposals, [&](const Proposal& each) { return is_same(each.effect, truth); });
  ASSERT_NE(sut, proposals.end());
  EXPECT_GT(sut->gain, 0.999);
  for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
    const Parameter& want = truth.parameters[i];
    const Parameter& got = sut->effect.parameters.at(i);
    EXPECT_NEAR(got.value, want.value, within) << i;
    // A nonlinearity's threshold may move by a factor of 50.
    const bool scales = want.name == "threshold";
    EXPECT_NEAR(got.lower, scales ? 0.02 * want.value : want.lower, within) << i;
    EXPECT_NEAR(got.upper, scales ? 50.0 * want.value : want.upper, within) << i;
  }
}

// The least step between two values is a twentieth of the moments', 1e-3 units.
TEST(TriedValuesTest, OneThatIsTrueIsProposedWithItsBounds) {
  for (Tried& each : all_tried()) {
    if (each.values.empty()) expect_proposed_as_it_is(each.truth, each.rate_hz, 3e-4);
    for (const double value : each.values) {
      each.truth.parameters[0].value = value * each.unit;
      SCOPED_TRACE(value);
      expect_proposed_as_it_is(each.truth, each.rate_hz, 3e-4 * each.unit);
    }
  }
}

// The column of each share of a square is the same but for a factor: bounds alone are certain.
TEST(TriedValuesTest, ASquareMayActTwiceEitherWay) {
  const Signals signals = signals_of(made::white(kCount, 4));
  for (const Proposal& sut : proposed("asymmetry", signals, made::two_pole_body())) {
    if (sut.effect.form != "square at the input") continue;
    double largest = 0.0;
    for (const double u : signals.at("u").values) largest = std::max(largest, std::abs(u));
    EXPECT_EQ(sut.effect.parameters[0].lower, -2.0);
    EXPECT_EQ(sut.effect.parameters[0].upper, 2.0);
    EXPECT_EQ(sut.effect.value(1), largest);
    return;
  }
  FAIL() << "none proposed";
}

// Limits keep their bounds in the fit: three times the largest size, a tenth of the middle one or a
// twentieth of where the limit began: 0.97 of an end of the range, or with 95 % of the samples
// within it.
TEST(TriedValuesTest, ALimitIsSoughtFarBeyondTheOutputAndCloseToZero) {
  const Signals signals = output_of(made::effect_of(
      "output_saturation", "hard, two limits", {},
      {{"upper_limit", "N", 0.9, 0.01, 9.0}, {"lower_limit", "N", -0.5, -9.0, 0.0}}));
  const std::vector<double>& y = signals.output().values;
  std::vector<double> size = y;
  for (double& each : size) each = std::abs(each);
  const double most = 3.0 * quantile_of(size, 1.0);
  std::size_t checked = 0;
  for (const Proposal& sut : proposed("output_saturation", signals, made::two_pole_body())) {
    const auto& limits = sut.effect.parameters;
    EXPECT_DOUBLE_EQ(limits[0].upper, most) << sut.effect.form;
    if (limits.size() == 1) {
      EXPECT_DOUBLE_EQ(limits[0].lower, 0.1 * quantile_of(size, 0.5)) << sut.effect.form;
    } else {
      // Clipped, so that the quantiles are the ends themselves.
      const bool within = limits[0].lower < 0.049 * quantile_of(y, 1.0);
      EXPECT_NEAR(limits[0].lower, 0.05 * (within ? 0.97 : 1.0) * 0.9, 1e-12);
      EXPECT_NEAR(limits[1].upper, 0.05 * (within ? 0.97 : 1.0) * -0.5, 1e-12);
      EXPECT_DOUBLE_EQ(limits[1].lower, -most);
      ++checked;
    }
  }
  EXPECT_GT(checked, 0u);
}

// h is a share of the deviation of the output that it leaves: a fixed point.
TEST(TriedValuesTest, PlayAtTheOutputIsAShareOfItsDeviation) {
  const Signals unmapped = signals_of(made::white(kCount, 4));
  const std::vector<double> body =
      free_run(made::model_of(made::two_pole_body()), unmapped).prediction;
  for (const double share : {0.1, 0.2, 0.4, 0.8}) {
    double y = 1.0;
    for (int i = 0; i < 60; ++i) {
      std::vector<double> left = body;
      for (double& each : left) each -= std::clamp(each, -share * y, share * y);
      y = deviation_of(left);
    }
    expect_proposed_as_it_is(
        {"dead_zone", "at the output", {}, {{"", "", share * y, 0.0, 3.0 * y}}, {}}, made::kRateHz,
        3e-4 * y);
  }
}

// Eleven delays; 77.5 ms lies between two of them, by steps of 10, 5 and 2.5 ms.  The second best
// is 15 ms or more away: of a delay that is too short the poles take over a part.
TEST(TriedValuesTest, ADelayIsRefinedFromTheBestThatWasTried) {
  const Body body{{{0.0, 0.1}}, {1.0, -0.9}};
  for (const double delay_s :
       {-0.03, 0.02, 0.04, 0.06, 0.08, 0.1, 0.13, 0.16, 0.2, 0.25, 0.3, 0.0775}) {
    const Effect truth{"delay", "of the input", {}, {{"delay", "s", delay_s, -0.1, 0.5}}, {}};
    const auto sut = proposed("delay", output_of(truth, body, 801), body);
    ASSERT_EQ(sut.size(), 2u) << delay_s;
    EXPECT_NEAR(sut[0].effect.value(0), delay_s, 1e-9);
    EXPECT_GT(sut[0].gain, 0.999) << delay_s;
    EXPECT_EQ(sut[0].effect.parameters[0].lower, -0.1);
    EXPECT_EQ(sut[0].effect.parameters[0].upper, 0.5);
    const double apart_s = std::abs(sut[1].effect.value(0) - delay_s);
    EXPECT_TRUE(apart_s > 0.015 && apart_s < 0.051) << delay_s << ", " << apart_s;
  }
}

// Eq. DG-38: of two modes of a body with four poles the one that explains less; the other is the
// body that it stood next to.
TEST(TriedValuesTest, AModeBetweenTheTriedOnesIsTakenOutOfALargerBody) {
  const Effect truth =
      made::effect_of("resonance", "beside the body", {},
                      {{"frequency", "Hz", 6.1}, {"damping_ratio", "-", 0.07}}, {0.02, -0.01});
  const Signals signals = output_of(truth);
  const Model model = made::model_of(made::two_pole_body());
  const Blocks blocks = make_blocks(signals);
  const ImpulseResponse none;
  const auto sut = effect_kind("resonance").proposed(Screening(model, signals, blocks, none));
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_GT(sut[1].gain, 0.9999);
  EXPECT_NEAR(sut[1].effect.value(0), 6.1, 1e-3);
  EXPECT_NEAR(sut[1].effect.value(1), 0.07, 1e-4);
  for (std::size_t i : {0, 1}) {
    EXPECT_NEAR(sut[1].effect.coefficients[i], truth.coefficients[i], 1e-4);
    EXPECT_NEAR(sut[1].body->denominator[i + 1], model.body.denominator[i + 1], 1e-4);
  }
}

// Five periods of the record's 20 s at least, 0.48 of the rate at most; over a position 1.5 periods
// of its 2 rad, and three samples a period at the median speed of 0.01 rad a sample.
TEST(TriedValuesTest, ALineIsSoughtWhereItCanBeTold) {
  const Effect tone{"tone", "beside the body", {}, {{"", ""}}, {0.3, 0.2}};
  const Effect ripple{"position_ripple", "one harmonic", {"swept"}, {{"", ""}}, {0.3, 0.2}};
  for (auto [truth, frequency, is] : {std::tuple{tone, 0.2, false},
                                      {tone, 0.3, true},
                                      {tone, 47.5, true},
                                      {tone, 49.0, false},
                                      {ripple, 0.65, false},
                                      {ripple, 1.0, true},
                                      {ripple, 31.0, true},
                                      {ripple, 36.0, false}}) {
    truth.parameters[0].value = frequency;
    // Tried in quarters of one over the range, of 20 s or 2 rad.
    const double within = truth.channels.empty() ? 0.13 / 20.0 : 0.13 / 2.0;
    const auto all = proposed(truth.kind, output_of(truth), made::two_pole_body());
    EXPECT_EQ(std::ranges::any_of(all,
                                  [&, line = frequency](const Proposal& sut) {
                                    return is_same(sut.effect, truth) &&
                                           std::abs(sut.effect.value(0) - line) < within;
                                  }),
              is)
        << truth.kind << ", " << frequency;
  }
}

}  // namespace stillhand::diagnosis::tried_values_test
