// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/body_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/fitting/fit.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::body_order_test {

constexpr std::size_t kCount = 6000;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The answer of a body to a ride, cut off at `limit`, with 5 % of noise.
Signals signals_of(const Body& body, double limit) {
  const auto u = made::ride(kCount, 1);
  auto y = made::answer(body, u);
  const double rms = made::rms_of(y);
  for (double& each : y) each = std::clamp(each, -limit * rms, limit * rms);
  return made::signals_of(u, made::mix({{1.0, y}, {0.05 * rms, made::white(kCount, 3)}}));
}

/// A body of order 2 with a limit at its output, fitted.
Model cut_off(const Signals& signals, const Blocks& blocks) {
  Model model = fit_baseline(signals, blocks, 2).model;
  const double rms = signals.output().deviation;
  model.effects = {
      {"output_saturation", "hard", {}, {{"limit", "N", rms, 0.1 * rms, 9.0 * rms}}, {}}};
  fit(model, signals, blocks, {});
  return model;
}

// Eq. DG-88.
std::optional<int> order_of(const Body& body, double limit) {
  const Signals signals = signals_of(body, limit);
  const Blocks blocks = make_blocks(signals);
  return order_instead(cut_off(signals, blocks), signals, blocks, 2, kUnknown, {});
}

TEST(OrderInsteadTest, TakesTheModesThatALowerOrderLacks) {
  EXPECT_EQ(order_of(made::four_pole_body(), 9.0), 4);
}

TEST(OrderInsteadTest, KeepsABendThatNoBodyHas) {
  EXPECT_EQ(order_of(made::two_pole_body(), 1.0), std::nullopt);
  EXPECT_EQ(order_of(made::four_pole_body(), 1.0), std::nullopt);
}

TEST(OrderInsteadTest, WithoutABendALongResponseSaysThatModesAreMissing) {
  for (const auto& [body, order] : {std::pair{made::four_pole_body(), std::optional(4)},
                                    {made::two_pole_body(), std::nullopt}}) {
    const Signals signals = signals_of(body, 9.0);
    const Blocks blocks = make_blocks(signals);
    const Baseline baseline = fit_baseline(signals, blocks, 2);
    const double long_rmse = baseline.impulse_response_rmse;
    EXPECT_EQ(order_instead(baseline.model, signals, blocks, 2, long_rmse, {}), order);
    EXPECT_EQ(order_instead(baseline.model, signals, blocks, 2, kUnknown, {}), std::nullopt);
    EXPECT_EQ(order_instead(baseline.model, signals, blocks, 0, long_rmse, {}), std::nullopt);
    EXPECT_EQ(order_instead(baseline.model, signals, blocks, 2, long_rmse, {.most_effects = 0}),
              std::nullopt);
  }
}

}  // namespace stillhand::diagnosis::body_order_test
