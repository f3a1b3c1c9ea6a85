// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/planted_limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "services/core/diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/every_effect.hpp"

namespace stillhand::diagnosis::planted_limits_test {

using made::white;

constexpr std::size_t kCount = 6000;
constexpr double kNoise = 0.2;

// A force of an input and of `path` times a channel, under white noise.
Measurement with_path(double path, std::size_t count = kCount) {
  const std::vector<double> input = made::ride(count, 3);
  const std::vector<double> other = made::ride(count, 5);
  const auto force = made::mix({{1.0, input}, {path, other}, {kNoise, white(count, 4)}});
  return made::measurement_of(
      {{"a_y", "m/s^2", input}, {"a_x", "m/s^2", other}, {"f", "N", force}});
}

const PlantedLimit* limit_of(const Diagnosis& diagnosis, const std::string& kind) {
  const auto found = std::ranges::find(diagnosis.limits, kind, &PlantedLimit::kind);
  return found == diagnosis.limits.end() ? nullptr : &*found;
}

TEST(PlantedLimitsTest, WhatIsLargerIsFoundAndWhatIsSmallerIsNot) {
  const Diagnosis none = diagnose(with_path(0.0), {});
  ASSERT_TRUE(none.effects.empty());
  const PlantedLimit* limit = limit_of(none, "coupled_input");
  ASSERT_NE(limit, nullptr);
  EXPECT_EQ(limit->channel, "a_x");
  // The channel has an RMS of 1, and the input's path cannot imitate it.
  EXPECT_GT(limit->beyond_linear, 0.95);
  const Diagnosis large = diagnose(with_path(2.0 * limit->half), {});
  ASSERT_FALSE(large.effects.empty());
  EXPECT_EQ(large.effects[0].effect.kind, "coupled_input");
  EXPECT_TRUE(diagnose(with_path(0.4 * limit->half), {}).effects.empty());
}

TEST(PlantedLimitsTest, TheShareFoundGrowsWithTheSizeAndCrossesHalfAtTheQuotedOne) {
  const Diagnosis sut = diagnose(with_path(0.0), {});
  for (const PlantedLimit& limit : sut.limits) {
    SCOPED_TRACE(limit.kind);
    EXPECT_TRUE(std::ranges::is_sorted(limit.found));
    for (std::size_t i = 0; i < kPlantedSizes.size(); ++i) {
      const double rms = kPlantedSizes[i] * sut.final_error.rmse;
      // The search for the size ends within 3 %; held-out and fitted RMS differ by less.
      if (rms > 1.1 * limit.half) {
        EXPECT_GE(limit.found[i], 0.5);
      } else if (rms < limit.half / 1.1) {
        EXPECT_LT(limit.found[i], 0.5);
      }
    }
  }
}

TEST(PlantedLimitsTest, AKindThatNoChannelAllowsIsNotAmongThem) {
  Measurement few = with_path(0.0);
  std::erase_if(few.channels, [](const Channel& channel) { return channel.name == "a_x"; });
  EXPECT_EQ(limit_of(diagnose(few, {}), "coupled_input"), nullptr);
  DiagnoseOptions options;
  options.inputs = {"u"};
  options.output = "y";
  options.search.most_effects = 0;
  Measurement all = made::every_channel(kCount, 7);
  const auto at = [&](const char* name) -> std::vector<double>& {
    return std::ranges::find(all.channels, name, &Channel::name)->values;
  };
  const std::vector<double> noise = white(kCount, 9);
  for (std::size_t n = 1; n < kCount; ++n) at("y")[n] = at("u")[n - 1] + kNoise * noise[n];
  std::set<std::string_view> kinds;
  const Diagnosis sut = diagnose(all, options);
  for (const PlantedLimit& limit : sut.limits) kinds.insert(limit.kind);
  for (const EffectKind* kind : effect_kinds()) {
    if (kind->any_shape()) continue;
    EXPECT_TRUE(kinds.contains(kind->name())) << kind->name();
  }
}

// Ten blocks: p cannot fall below 2^-10, and only the rule for large effects is left, a fall of
// 15 %: 1/0.85^2 - 1 = 0.384 of the power.
TEST(PlantedLimitsTest, AShortRecordShowsOnlyWhatIsLarge) {
  const Diagnosis sut = diagnose(with_path(0.0, 2000), {});
  const PlantedLimit* limit = limit_of(sut, "coupled_input");
  ASSERT_NE(limit, nullptr);
  EXPECT_NEAR(limit->half, std::sqrt(0.384) * kNoise, 0.15 * std::sqrt(0.384) * kNoise);
}

// Behind the noise model slow noise is smaller than white noise of the same RMS.
TEST(PlantedLimitsTest, SlowNoiseIsWhitenedBeforeTheLimitIsTaken) {
  const std::vector<double> input = white(kCount, 3);
  const std::vector<double> e = white(kCount, 4);
  const auto limit_under = [&](double pole) {
    const auto noise = made::answer({std::sqrt(1.0 - pole * pole)}, {1.0, -pole}, e);
    const auto force = made::mix({{1.0, input}, {kNoise, noise}});
    return diagnose(made::measurement_of({{"a_y", "m/s^2", input}, {"f", "N", force}}), {})
        .detection_limit;
  };
  EXPECT_LT(limit_under(0.98), limit_under(0.0));
}

}  // namespace stillhand::diagnosis::planted_limits_test
