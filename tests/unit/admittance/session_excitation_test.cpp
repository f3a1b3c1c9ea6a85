// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/session_excitation.hpp"

#include <gmock/gmock.h>

#include "services/core/contract/config_error.hpp"

namespace stillhand::admittance::session_excitation_test {
namespace {

TEST(SessionExcitationTest, FillsTheBandWithAsManyLinesAsItHasRoomFor) {
  const ExcitationConfig sut = session_excitation({40.0, 7, true});
  EXPECT_EQ(sut.lines, 20);
  EXPECT_EQ(sut.lowest_hz, 0.05);
  EXPECT_EQ(sut.seed, 7);
  EXPECT_TRUE(sut.swapped);
  const ExcitationConfig brief = session_excitation({3.0, 1});
  EXPECT_EQ(brief.lowest_hz, 1.0 / 3.0);
  EXPECT_LT(brief.lines, 20);
  ExcitationConfig more = brief;
  ++more.lines;
  EXPECT_THROW(interleaved_harmonics(more), ConfigError);
}

TEST(SessionExcitationTest, TheTextInTheRecordingGivesItBack) {
  const SessionPerturbation said{1.0 / 3.0, 18446744073709551615u};
  const SessionPerturbation read = perturbation_in(in_words(said));
  EXPECT_EQ(read.period_s, said.period_s);
  EXPECT_EQ(read.seed, said.seed);
  EXPECT_TRUE(perturbation_in(in_words({4.0, 7, true})).swapped);
  EXPECT_EQ(perturbation_in("interleaved multisines: period 4 s, seed 7, more").period_s, 0.0);
  EXPECT_EQ(perturbation_in("ride: high-pass at 0.1 Hz").period_s, 0.0);
}

// Harmonic k of a period is harmonic k P of a trial of P periods.
TEST(SessionExcitationTest, MotionOfATrialHasTheLinesOfThePeriod) {
  const SessionPerturbation perturbation{4.0, 1};
  const auto lines = motion_components(perturbation, 20'000);
  const auto period = design(session_excitation(perturbation)).motion.components();
  ASSERT_EQ(lines.size(), period.size());
  EXPECT_EQ(lines[2].harmonic, 5 * period[2].harmonic);
  EXPECT_EQ(lines[2].phase_rad, period[2].phase_rad);
  EXPECT_THAT([&] { motion_components(perturbation, 21'000); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("whole periods")));
}

TEST(SessionExcitationTest, RefusesAPeriodOutOfRange) {
  for (const double period_s : {1.9, 201.0}) {
    EXPECT_THROW(session_excitation({period_s, 1}), ConfigError);
  }
  for (const double period_s : {2.0, 200.0}) EXPECT_NO_THROW(session_excitation({period_s, 1}));
}

}  // namespace
}  // namespace stillhand::admittance::session_excitation_test
