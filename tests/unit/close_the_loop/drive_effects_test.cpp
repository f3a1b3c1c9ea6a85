// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/drive_effects.hpp"

#include <gtest/gtest.h>

namespace stillhand::close_the_loop::drive_effects_test {
namespace {

using cancellation::Channel;

TEST(DriveEffectsTest, FrictionOfTheStickIsTakenOverInPart) {
  ConvertedModel sut;
  add_drive_effect({"coulomb_friction", "sign, beside the body", {"omega"}, {}, {-0.5}}, 0.8, sut);
  ASSERT_EQ(sut.model.paths.size(), 1u);
  EXPECT_EQ(sut.model.paths[0].channel, Channel::kOmega);
  EXPECT_DOUBLE_EQ(sut.model.paths[0].gain, 0.4);
  // A sharp sign gets the narrowest transition that the encoder allows: 0.05 rad/s.
  EXPECT_DOUBLE_EQ(sut.model.paths[0].map.high, 8.0 * 0.05);
  ASSERT_EQ(sut.treatments.size(), 1u);
  EXPECT_TRUE(sut.treatments[0].cancelled);
}

TEST(DriveEffectsTest, RippleOfTheStickBecomesWavesOfTheOppositeSign) {
  ConvertedModel sut;
  add_drive_effect({"position_ripple",
                    "two harmonics",
                    {"theta"},
                    {{"spatial_frequency", "1/rad", 4.0}},
                    {0.1, 0.2, 0.3, 0.4}},
                   0.8, sut);
  ASSERT_EQ(sut.model.waves.size(), 2u);
  EXPECT_EQ(sut.model.waves[1].channel, Channel::kTheta);
  EXPECT_EQ(sut.model.waves[1].frequency, 8.0);
  EXPECT_EQ(sut.model.waves[1].sine_n, -0.3);
  EXPECT_EQ(sut.model.waves[1].cosine_n, -0.4);
  EXPECT_TRUE(sut.treatments.at(0).cancelled);
}

TEST(DriveEffectsTest, OtherEffectsAndChannelsAreLeftOutWithAReason) {
  ConvertedModel sut;
  add_drive_effect({"coulomb_friction", "sign, beside the body", {"alpha"}, {}, {-0.5}}, 0.8, sut);
  add_drive_effect({"coupled_input", "static", {"theta"}, {}, {1.0}}, 0.8, sut);
  add_drive_effect({"tone", "beside the body", {}, {{"f", "Hz", 9.0}}, {1.0, 0.0}}, 0.8, sut);
  EXPECT_TRUE(sut.model.paths.empty());
  EXPECT_TRUE(sut.model.waves.empty());
  ASSERT_EQ(sut.treatments.size(), 3u);
  for (const Treatment& each : sut.treatments) {
    EXPECT_FALSE(each.cancelled);
    EXPECT_FALSE(each.how.empty());
  }
}

}  // namespace
}  // namespace stillhand::close_the_loop::drive_effects_test
