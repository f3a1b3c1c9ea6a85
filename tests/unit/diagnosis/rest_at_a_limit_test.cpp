// SPDX-License-Identifier: Apache-2.0
// An output that rests at an end of its range, Eq. DG-89.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <span>
#include <utility>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::rest_at_a_limit_test {

constexpr std::size_t kCount = 6000;
constexpr double kLimit = 0.9;

// A leaky tank, [V] over [V]: sum of a ride and two pulses that fill it.
std::vector<double> inflow() {
  std::vector<double> u = made::ride(kCount, 1);
  for (const std::size_t first : {1400u, 4100u}) {
    for (std::size_t n = first; n < first + 120; ++n) u[n] += 3.0;
  }
  return u;
}

// y(n) = 0.98 y(n-1) + 0.02 u(n-1) + noise, by a tank that overflows.
std::vector<double> overflowing(const std::vector<double>& u) {
  const auto noise = made::white(kCount, 7);
  std::vector<double> y(kCount, 0.0);
  for (std::size_t n = 1; n < kCount; ++n) {
    y[n] = std::min(0.98 * y[n - 1] + 0.02 * u[n - 1] + 0.002 * noise[n], kLimit);
  }
  return y;
}

// The same tank without a rim, and a sensor that ends.
std::vector<double> clipped(const std::vector<double>& u) {
  std::vector<double> y = made::mix(
      {{1.0, made::answer({0.0, 0.02}, {1.0, -0.98}, u)}, {0.01, made::white(kCount, 7)}});
  for (double& each : y) each = std::min(each, kLimit);
  return y;
}

Diagnosis diagnosed(const std::vector<double>& u, const std::vector<double>& y) {
  DiagnoseOptions options;
  options.inputs = {"u"};
  options.output = "y";
  options.search.most_effects = 1;
  return diagnose(made::measurement_of({{"u", "V", u}, {"y", "V", y}}), options);
}

// Two rests, in five of thirty blocks; or it runs dry.
TEST(RestAtALimitTest, ATankThatOverflowsTwiceIsStopped) {
  for (const auto& [sign, form] : {std::pair{1.0, "stop above"}, {-1.0, "stop below"}}) {
    const Diagnosis sut =
        diagnosed(made::mix({{sign, inflow()}}), made::mix({{sign, overflowing(inflow())}}));
    ASSERT_EQ(sut.effects.size(), 1u);
    EXPECT_EQ(sut.effects[0].effect.kind, "output_saturation");
    EXPECT_EQ(sut.effects[0].effect.form, form);
    EXPECT_EQ(sut.effects[0].effect.value(0), sign * kLimit);
    EXPECT_EQ(sut.effects[0].carried, 1.0);
  }
}

TEST(RestAtALimitTest, ASensorThatEndsIsNoStop) {
  const Diagnosis sut = diagnosed(inflow(), clipped(inflow()));
  ASSERT_EQ(sut.effects.size(), 1u);
  EXPECT_EQ(sut.effects[0].effect.kind, "output_saturation");
  EXPECT_FALSE(sut.effects[0].effect.form.starts_with("stop")) << sut.effects[0].effect.form;
}

struct Rest {
  std::size_t rows;       // at the end of the range
  std::size_t elsewhere;  // at another level
  std::size_t next;       // with the value that is next to the end
  bool moves;             // the body's answer meanwhile: as much as it can, or as little
  int proposed;           // a stop and a clip
};

// How many are proposed where the answer of a body of 4 s rests; sign: above, below.
auto proposed_at(const Rest& rest, double sign) {
  const auto u = made::ride(401, 1);
  std::vector<double> y = made::answer(made::two_pole_body(), u);
  const double end = 5.0 * sign * made::rms_of(y);
  const auto move = [&](const std::ptrdiff_t n) {
    const auto part = std::span(y).subspan(static_cast<std::size_t>(n), rest.rows);
    return (rest.moves ? 1.0 : -1.0) * (std::ranges::max(part) - std::ranges::min(part));
  };
  const auto places = std::views::iota(std::ptrdiff_t{200}, std::ptrdiff_t{300});
  std::fill_n(y.begin() + *std::ranges::max_element(places, {}, move), rest.rows, end);
  std::fill_n(y.begin() + 320, rest.elsewhere, y[320]);
  for (std::size_t i = 0; i < rest.next; ++i) y[100 + 20 * i] = 0.99 * end;
  const Signals signals = made::signals_of(u, y);
  // With another effect in the model no body is estimated again.
  const Model model = made::model_of(made::two_pole_body(), {{"drift", "linear", {}, {}, {0.0}}});
  const Blocks blocks = make_blocks(signals);
  const ImpulseResponse none;
  const EffectKind& kind = effect_kind("output_saturation");
  const auto all = kind.proposed(Screening(model, signals, blocks, none));
  return std::ranges::count_if(all, [&](const Proposal& sut) {
    return kind.shows_in_rows(sut.effect) && sut.effect.value(0) == end;
  });
}

// Five rows at least, twice as many as rest elsewhere, four times as many as have the next value,
// where the model without a stop moves.
TEST(RestAtALimitTest, ARestIsLongerThanAnyOther) {
  for (const Rest& rest : {Rest{4, 1, 1, true, 0},
                           {5, 1, 1, true, 2},
                           {5, 3, 1, true, 0},
                           {6, 3, 1, true, 2},
                           {7, 1, 2, true, 0},
                           {8, 1, 2, true, 2},
                           {8, 1, 2, false, 0}}) {
    for (const double sign : {1.0, -1.0}) {
      EXPECT_EQ(proposed_at(rest, sign), rest.proposed)
          << sign << ", " << rest.rows << ", " << rest.elsewhere << ", " << rest.next;
    }
  }
}

// It rests at its end because the input does.
TEST(RestAtALimitTest, AnOutputThatHasSettledHasNoLimit) {
  std::vector<double> u(kCount, 0.0);
  for (std::size_t n = 0; n < kCount; ++n) u[n] = n % 2000 < 1000 ? 0.3 : -1.0;
  std::vector<double> y = made::answer({0.0, 0.05, 0.02}, {1.0, -0.9, 0.1}, u);
  for (double& each : y) each = std::round(each * 200.0) / 200.0;
  for (const FoundEffect& found : diagnosed(u, y).effects) {
    EXPECT_FALSE(effect_kind(found.effect.kind).shows_in_rows(found.effect)) << found.effect.form;
  }
}

}  // namespace stillhand::diagnosis::rest_at_a_limit_test
