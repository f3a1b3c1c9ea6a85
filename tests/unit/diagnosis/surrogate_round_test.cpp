// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/surrogate_round.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/diagnosis/detection/surrogates.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::surrogate_round_test {

constexpr std::size_t kCount = 3000;

// A round on a static model, so that it takes little: y = 2 u + of_v v + tone + noise of 0.1.
struct Round {
  Round(double of_v, double of_tone, std::uint64_t seed = 4)
      : signals(measurement(of_v, of_tone, seed), {"u"}, "y"),
        blocks(make_blocks(signals)),
        baseline(fit_baseline(signals, blocks, 0)),
        impulse_response(fit_impulse_response(signals)),
        settings{blocks, impulse_response, baseline.order, options, for_each} {
    const double rmse = held_out(baseline.model, signals, blocks).rmse();
    tried =
        finished_trials(screened_trials(baseline.model, rmse, signals, settings, Shapes::kNamed),
                        rmse, signals, settings);
  }

  [[nodiscard]] static Measurement measurement(double of_v, double of_tone, std::uint64_t seed) {
    const auto u = made::ride(kCount, 1);
    const auto v = made::ride(kCount, 2);
    auto y = made::mix({{2.0, u}, {of_v, v}, {0.1, made::white(kCount, seed)}});
    for (std::size_t n = 0; n < kCount; ++n) {
      const double t = static_cast<double>(n) / made::kRateHz;
      y[n] += of_tone * std::sin(2.0 * std::numbers::pi * 5.0 * t);
    }
    return made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", y}});
  }

  // Of the best that surrogates test.
  [[nodiscard]] double p() const {
    const auto best = std::ranges::find_if(tried, is_tested_by_surrogates);
    const std::vector<double> all = surrogate_p_of(tried, baseline.model, signals, settings);
    return all[static_cast<std::size_t>(best - tried.begin())];
  }

  SearchOptions options;
  ForEach for_each = in_order;
  Signals signals;
  Blocks blocks;
  Baseline baseline;
  ImpulseResponse impulse_response;
  RoundSettings settings;
  std::vector<Trial> tried;
};

TEST(SurrogateRoundTest, WhatAChannelExplainsNoSurrogateGives) {
  EXPECT_EQ(Round(0.03, 0.0).p(), 1.0 / (1.0 + kSurrogates));
}

// One like the others.  The numbers that were fitted to it make p a little small.
TEST(SurrogateRoundTest, OfNoiseAloneSurrogatesGiveAsMuch) {
  constexpr std::uint64_t kRounds = 10;
  double sum = 0.0;
  for (std::uint64_t seed = 10; seed < 10 + kRounds; ++seed) sum += Round(0.0, 0.0, seed).p();
  EXPECT_GT(sum / kRounds, 0.2);
}

// A surrogate keeps it, and what is left is noise.
TEST(SurrogateRoundTest, WhatTimeAloneExplainsIsNotAsked) {
  const Round round(0.0, 0.3);
  EXPECT_EQ(round.tried.front().model.effects.front().kind, "tone");
  EXPECT_FALSE(is_tested_by_surrogates(round.tried.front()));
  EXPECT_EQ(surrogate_p_of(round.tried, round.baseline.model, round.signals, round.settings)[0],
            0.0);
  EXPECT_GT(round.p(), kSurrogateSignificance);
}

// A gain over time acts through the inputs.
TEST(SurrogateRoundTest, AGainOverTimeIsTested) {
  Trial gain;
  gain.model.effects = {{"regime_change", "", {}, {{"change", "-", 0.1}, {"t", "s", 1.0}}, {}}};
  EXPECT_TRUE(is_tested_by_surrogates(gain));
}

}  // namespace stillhand::diagnosis::surrogate_round_test
