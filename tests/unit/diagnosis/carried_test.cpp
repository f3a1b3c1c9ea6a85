// SPDX-License-Identifier: Apache-2.0
// What of a found model predicts another recording, Eq. DG-58 and DG-59.
#include "services/core/diagnosis/carried.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/diagnosis/apart_from_time.hpp"
#include "services/core/diagnosis/parts_out.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::carried_test {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::size_t kCount = 6000;
constexpr double kLength_s = 60.0;

double time_s(std::size_t n) { return 0.01 * static_cast<double>(n); }

// A room that warms up, with a thermostat's waves of `waves` degrees.
std::vector<double> temperature(double waves) {
  std::vector<double> x(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    x[n] = 23.0 + 4.0 * (1.0 - std::exp(-time_s(n) / 20.0)) + waves * std::sin(0.9 * time_s(n));
  }
  return x;
}

struct Made {
  std::vector<double> u = made::ride(kCount, 1);
  std::vector<double> v = made::ride(kCount, 2);
  std::vector<double> temp = temperature(0.4);
  std::vector<double> y = made::white(kCount, 3);

  // 2 u + noise of 0.1 + more
  explicit Made(const std::function<double(const Made&, std::size_t)>& more) {
    for (std::size_t n = 0; n < kCount; ++n) y[n] = 0.1 * y[n] + 2.0 * u[n] + more(*this, n);
  }
  [[nodiscard]] Measurement measurement() const {
    return made::measurement_of(
        {{"u", "V", u}, {"v", "V", v}, {"temp", "degC", temp}, {"y", "N", y}});
  }
};

// Fitted with these effects, and what is carried of it.
struct Sut {
  Sut(const Measurement& measurement, std::vector<Effect> effects)
      : studied(measurement, 0), found(studied.baseline.model) {
    found.effects = std::move(effects);
    fit(found, studied.signals, studied.blocks);
    carried = carried_model(found, studied.baseline.model, studied.signals, studied.blocks);
  }
  made::Studied studied;
  Model found;
  CarriedModel carried;
};

const Effect kOfV{"coupled_input", "static", {"v"}, {}, {0.0}};
const Effect kOfTemp{"coupled_input", "static", {"temp"}, {}, {0.0}};
const Effect kDrift{"drift", "exponential", {}, {{"time_constant", "s", 20.0, 1.0, 100.0}}, {0.0}};

TEST(CarriedTest, WhereNothingWasFoundItIsTheBaselineOverTheInputsBand) {
  const Sut sut(Made([](const Made&, std::size_t) { return 0.0; }).measurement(), {});
  EXPECT_EQ(packed(sut.carried.model), packed(sut.studied.baseline.model));
  EXPECT_THAT(sut.carried.left_out, IsEmpty());
  EXPECT_THAT(sut.carried.inputs, SizeIs(1));
  ASSERT_THAT(sut.carried.bands, SizeIs(1));
  EXPECT_EQ(sut.carried.bands[0].of, "u");
  // made::ride(): 0.5 to 8 Hz, with the skirts of its filter.
  EXPECT_GT(sut.carried.bands[0].low_hz, 0.2);
  EXPECT_LT(sut.carried.bands[0].low_hz, 1.0);
  EXPECT_GT(sut.carried.bands[0].high_hz, 3.0);
  EXPECT_LT(sut.carried.bands[0].high_hz, 16.0);
}

// An exponential's offset is where it ends; another recording begins where this one did.  The
// baseline's is the mean.
TEST(CarriedTest, OfADriftAloneTheBaselineIsLeft) {
  const Sut sut(Made([](const Made&, std::size_t n) {
                  return 3.0 * std::exp(-time_s(n) / 20.0);
                }).measurement(),
                {kDrift});
  EXPECT_GT(std::abs(sut.found.body.offset - sut.studied.baseline.model.body.offset), 0.5);
  EXPECT_EQ(packed(sut.carried.model), packed(sut.studied.baseline.model));
  ASSERT_THAT(sut.carried.left_out, SizeIs(1));
  EXPECT_EQ(sut.carried.left_out[0].effect.kind, "drift");
}

// A body that was fitted next to a tone may have poles and zeros outside of the band that the
// baseline's does not have; nothing is known of the two there.
TEST(CarriedTest, WithoutAnEffectTheBodyIsTheBaselinesWhateverItsOrder) {
  const made::Studied studied(
      Made([](const Made&, std::size_t n) { return std::sin(9.7 * time_s(n)); }).measurement(), 0);
  Model found = fit_baseline(studied.signals, studied.blocks, 2).model;
  found.effects = {{"tone", "fixed", {}, {{"frequency", "Hz", 1.54, 1.5, 1.6}}, {0.0, 0.0}}};
  fit(found, studied.signals, studied.blocks);
  const CarriedModel sut =
      carried_model(found, studied.baseline.model, studied.signals, studied.blocks);
  EXPECT_EQ(packed(sut.model), packed(studied.baseline.model));
}

// One that the input excites all the time.
TEST(CarriedTest, AModeThatDecaysIsCarried) {
  double y[2] = {0.0, 0.0};
  const Sut sut(Made([&](const Made& made, std::size_t n) {
                  // A pair of poles at 2 Hz that decays in 0.8 s.
                  const double next =
                      2.0 * 0.9875 * std::cos(2.0 * std::numbers::pi * 0.02) * y[0] -
                      0.9875 * 0.9875 * y[1] + made.u[n];
                  y[1] = y[0];
                  y[0] = next;
                  return 0.1 * next;
                }).measurement(),
                {{"resonance",
                  "beside the body",
                  {},
                  {{"frequency", "Hz", 1.9, 0.15, 40.0}, {"damping_ratio", "-", 0.1, 0.003, 0.95}},
                  {0.0, 0.0}}});
  EXPECT_THAT(sut.carried.model.effects, SizeIs(1));
}

TEST(CarriedTest, AnEffectThatTheInputsDetermineIsCarriedWithItsRange) {
  const Sut sut(Made([](const Made& m, std::size_t n) {
                  return 0.5 * m.v[n] + 3.0 * std::exp(-time_s(n) / 20.0);
                }).measurement(),
                {kDrift, kOfV});
  ASSERT_THAT(sut.carried.model.effects, SizeIs(1));
  const Effect& effect = sut.carried.model.effects[0];
  EXPECT_EQ(effect.kind, "coupled_input");
  // Noise of a drift's 0.8 and 0.1 over 6000 samples.
  EXPECT_NEAR(effect.coefficients[0], 0.5, 0.05);
  ASSERT_THAT(effect.seen, SizeIs(1));
  EXPECT_EQ(effect.seen[0].of, "v");
  EXPECT_LT(effect.seen[0].low, -2.0);
  EXPECT_GT(effect.seen[0].high, 2.0);
  // In the same session the clock goes on; next to the drift 0.1/sqrt(5900).
  ASSERT_THAT(sut.carried.in_session.effects, SizeIs(2));
  EXPECT_NEAR(sut.carried.in_session.effects[0].coefficients[0], 0.5, 0.005);
  EXPECT_EQ(sut.carried.in_session.effects[0].seen[0].high, effect.seen[0].high);
  const CarriedModel none = carried_model(sut.found, sut.studied.baseline.model,
                                          sut.studied.signals, sut.studied.blocks, {true, false});
  ASSERT_THAT(none.left_out, SizeIs(2));
  EXPECT_THAT(none.left_out[1].why, HasSubstr("less than what counts"));
}

// 0.5, 0.5 and 0.2 in the thirds; a fit to the others has 0.35, 0.35 and 0.5.  The share is 0.45 of
// 0.495; its parts miss it by 0.0636, 0.0636 and -0.1273, the standard error is 0.386, and what is
// left is 0.909 (1 - 0.424^2).
TEST(CarriedTest, AnEffectThatThePartsAgreeOnInPartIsCarriedInPart) {
  const Sut sut(Made([](const Made& m, std::size_t n) {
                  return (n < 2 * kCount / 3 ? 0.5 : 0.2) * m.v[n];
                }).measurement(),
                {kOfV});
  ASSERT_THAT(sut.carried.model.effects, SizeIs(1));
  EXPECT_NEAR(sut.carried.model.effects[0].share, 0.745, 0.04);
}

TEST(CarriedTest, AnEffectThatHelpsToPredictNothingIsDropped) {
  const Sut sut(Made([](const Made& m, std::size_t n) {
                  return n < kCount / 3 ? 0.3 * m.v[n] : (n < 2 * kCount / 3 ? -0.3 : 0.0) * m.v[n];
                }).measurement(),
                {kOfV});
  EXPECT_THAT(sut.carried.model.effects, IsEmpty());
  EXPECT_EQ(packed(sut.carried.model), packed(sut.studied.baseline.model));
}

// 0.05 N/K: 0.2 N of warming up, 0.014 N RMS of waves in noise of 0.1, over 5900 samples.
TEST(CarriedTest, ATemperatureThatIsBorneOutByItsWavesIsCarried) {
  const Sut sut(Made([](const Made& m, std::size_t n) { return 0.2 * m.temp[n]; }).measurement(),
                {kOfTemp});
  EXPECT_GT(apart_from_time(sut.found, 0, sut.studied.signals, sut.studied.blocks), 0.95);
  ASSERT_THAT(sut.carried.model.effects, SizeIs(1));
  EXPECT_NEAR(sut.carried.model.effects[0].coefficients[0], 0.2, 0.01);
}

// The same, but the force follows the clock and the temperature only looks alike.
TEST(CarriedTest, ATemperatureThatOnlyLooksLikeADriftIsLeftOut) {
  const Sut sut(Made([](const Made&, std::size_t n) {
                  return -0.8 * std::exp(-time_s(n) / 18.0);
                }).measurement(),
                {kOfTemp});
  EXPECT_EQ(apart_from_time(sut.found, 0, sut.studied.signals, sut.studied.blocks), 0.0);
  EXPECT_THAT(sut.carried.model.effects, IsEmpty());
  ASSERT_THAT(sut.carried.left_out, SizeIs(1));
  EXPECT_THAT(sut.carried.left_out[0].why, HasSubstr("time alone"));
  EXPECT_TRUE(sut.carried.left_out[0].like_time);
}

// Three recordings; v is `elsewhere` times as large in the last two, and acts with `gain`.
Measurement three_recordings(double gain, double elsewhere) {
  Made data([](const Made&, std::size_t) { return 0.0; });
  for (std::size_t n = 0; n < kCount; ++n) {
    if (n >= kCount / 3) data.v[n] *= elsewhere;
    data.y[n] += gain * data.v[n];
  }
  Measurement joined = data.measurement();
  joined.stretches.clear();
  for (std::size_t r = 0; r < 3; ++r) {
    joined.stretches.push_back(
        {r * kCount / 3, (r + 1) * kCount / 3, kLength_s * static_cast<double>(r) / 3.0, r});
  }
  return joined;
}

// v acts in the first one alone, and without harm to the others.
TEST(CarriedTest, AnEffectOfOneOfSeveralRecordingsIsDropped) {
  const Sut sut(three_recordings(0.2, 0.0), {kOfV});
  EXPECT_THAT(sut.carried.model.effects, IsEmpty());
}

// 0.008 N in noise of 0.1 N: the others determine the gain to 0.04 of 0.2, and it lowers their
// error by 0.3 %, that of the first one by half.
TEST(CarriedTest, AnEffectThatOtherRecordingsBearOutMayHelpOneAlone) {
  const Sut sut(three_recordings(0.2, 0.04), {kOfV});
  ASSERT_THAT(sut.carried.model.effects, SizeIs(1));
  EXPECT_NEAR(sut.carried.model.effects[0].coefficients[0], 0.2, 0.01);
}

TEST(CarriedTest, BurstsAreLeftOutOfTheFitAndOfNothingElse) {
  const Made data([](const Made& m, std::size_t n) {
    return 0.5 * m.v[n] + (n % 1000 < 20 ? 20.0 * m.u[n] : 0.0);
  });
  Effect bursts{"transients", "isolated bursts", {}, {}, {}};
  for (int i = 0; i < 6; ++i) {
    bursts.parameters.push_back({"begin", "s", 10.0 * i - 0.05, -1.0, 99.0, false});
    bursts.parameters.push_back({"end", "s", 10.0 * i + 0.25, -1.0, 99.0, false});
  }
  const Sut sut(data.measurement(), {bursts, kOfV});
  ASSERT_THAT(sut.carried.model.effects, SizeIs(1));
  EXPECT_EQ(sut.carried.model.effects[0].kind, "coupled_input");
  EXPECT_NEAR(sut.carried.model.body.numerators[0][0], 2.0, 0.01) << "as without bursts";
  EXPECT_GT(std::abs(sut.studied.baseline.model.body.numerators[0][0] - 2.0), 0.05);
}

// y = 2 u + c v, c = 1, 2 and 4 in the thirds, u and v square waves of 50 and 25 Hz; 1900, 2000 and
// 2000 samples count.  A fit to the others has their mean, m.  Of a residual c v the effect
// explains m v: in the first third, where m = 3 c, a share s is harmless with 3 s - 1 = 1.05.
TEST(PartsOutTest, EachThirdIsPredictedByAFitToTheOthers) {
  const Eigen::Array3d rows(1900.0, 2000.0, 2000.0);
  const Eigen::Array3d c(1.0, 2.0, 4.0);
  const Eigen::Array3d m(3.0, 9900.0 / 3900.0, 5900.0 / 3900.0);
  std::vector<double> u, v, y;
  for (std::size_t n = 0; n < kCount; ++n) {
    u.push_back(n % 2 == 0 ? 1.0 : -1.0);
    v.push_back(n % 4 < 2 ? 1.0 : -1.0);
    y.push_back(2.0 * u[n] + c(static_cast<Eigen::Index>(n / 2000)) * v[n]);
  }
  const Signals signals(made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", y}}), {"u"},
                        "y");
  const Model bare = made::model_of({{{1.0}}, {1.0}, 0.0});
  const Model with = made::model_of(bare.body, {{"coupled_input", "static", {"v"}, {}, {1.0}}});
  const PartsOut sut(with, signals, make_blocks(signals), made::column_of(made::white(kCount, 1)),
                     1.0, 5);
  const OutOfParts left = sut.left_by(with);
  for (const int n : {100, 1999, 2000, 3999, 4000, 5999}) {
    EXPECT_NEAR(left.residual[n], (c - m)(n / 2000) * (n % 4 < 2 ? 1.0 : -1.0), 1e-6) << n;
  }
  EXPECT_NEAR(sut.rmse(with), std::sqrt((rows * (c - m).square()).sum() / 5900.0), 1e-6);
  const HeldOut started = sut.from_start(with);
  EXPECT_NEAR(started.squares[10], 195.0 * std::pow(c(1) - m(1), 2), 1e-3) << "five give the start";
  EXPECT_EQ(started.weights[0], 100.0);
  const OutOfParts without = sut.left_by(bare);
  EXPECT_NEAR(sut.share(without, left).estimate, (rows * c * m).sum() / (rows * m * m).sum(), 1e-6);
  EXPECT_NEAR(sut.share(without, left).harmless, 2.05 / 3.0, 1e-6);
  EXPECT_EQ(sut.share({}, left).estimate, 1.0) << "without it the model runs away";
  EXPECT_NEAR(sut.slow_share(without, left), 0.5, 0.002) << "means of two samples of v";
}

// y(n) = 0.9 y(n-1) + 0.2 u(n-1), begun at x: x 0.9^n more.  Of a unit spread times f, 20 rows with
// noise of variance sum 0.81^n give f^2/(f^2 + 1) x, and f is the one of 1, 3, 10 and 30 that makes
// ln(f^2 + 1) + x^2/(f^2 + 1) the least.
TEST(MostLikelyStartTest, AStateIsDrawnToNoneByTheNoiseOverItsSpread) {
  const Model model = made::model_of({{{0.0, 0.2}}, {1.0, -0.9}, 0.0});
  const auto u = made::white(200, 1);
  const Signals signals = made::signals_of(u, u);
  const Answer answer = [&](const Signals& each) { return free_run(model, each).prediction; };
  const double noise = std::sqrt((1.0 - std::pow(0.81, 20)) / 0.19);
  for (const auto& [x, f] : {std::pair{1.0, 1.0}, {-4.0, 3.0}, {12.0, 10.0}, {-20.0, 30.0}}) {
    GivenRows rows(1);
    auto measured = answer(started(model, signals, Eigen::MatrixXd::Zero(1, 1)));
    for (std::size_t n = 0; n < 20; ++n) {
      rows[0].push_back(n);
      measured[n] += x * std::pow(0.9, n);
    }
    const Eigen::MatrixXd sut = most_likely_start(model, signals, Eigen::MatrixXd::Ones(1, 1),
                                                  measured, rows, noise, answer);
    EXPECT_NEAR(sut(0, 0), f * f / (f * f + 1.0) * x, 1e-9);
  }
}

}  // namespace stillhand::diagnosis::carried_test
