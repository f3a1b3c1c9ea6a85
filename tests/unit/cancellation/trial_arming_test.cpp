// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/trial_arming.hpp"

#include <gtest/gtest.h>

namespace stillhand::cancellation::trial_arming_test {
namespace {

constexpr Trial kTracking{3, TrialPhase::kTracking, 1000, 500, 100};

TrialArming with(const Trial& trial, const Assignment& assignment) {
  TrialArming sut;
  sut.announce(trial);
  sut.assign(assignment);
  return sut;
}

TEST(TrialArmingTest, NothingIsArmedBeforeAnAssignment) {
  TrialArming sut;
  EXPECT_EQ(sut.readiness(true, std::nullopt), Readiness::kUnassigned);
  EXPECT_FALSE(sut.acts(0, {}));
  sut.announce(kTracking);
  EXPECT_EQ(sut.readiness(true, std::nullopt), Readiness::kUnassigned);
  EXPECT_FALSE(sut.acts(1200, {}));
}

TEST(TrialArmingTest, TrialAndAssignmentComeInEitherOrder) {
  TrialArming sut;
  sut.assign({3, true});
  EXPECT_EQ(sut.readiness(true, std::nullopt), Readiness::kUnassigned);
  sut.announce(kTracking);
  EXPECT_EQ(sut.readiness(true, std::nullopt), Readiness::kArmed);
  EXPECT_TRUE(sut.acts(1200, {}));
}

TEST(TrialArmingTest, AnAssignmentOfAnotherTrialDoesNotCount) {
  const TrialArming sut = with(kTracking, {2, true});
  EXPECT_EQ(sut.readiness(true, std::nullopt), Readiness::kUnassigned);
  EXPECT_FALSE(sut.acts(1200, {}));
}

TEST(TrialArmingTest, ATrialWithCancellationNeedsAModel) {
  const TrialArming sut = with(kTracking, {3, true});
  EXPECT_EQ(sut.readiness(false, std::nullopt), Readiness::kNoModel);
  EXPECT_EQ(sut.readiness(false, 1000), Readiness::kArmed);  // its first measured tick
  EXPECT_EQ(sut.readiness(false, 1001), Readiness::kModelTooLate);
  EXPECT_EQ(sut.readiness(true, 1001), Readiness::kArmed);  // with the one in use
}

TEST(TrialArmingTest, ATrialWithoutCancellationNeedsNone) {
  const TrialArming sut = with(kTracking, {3, false});
  EXPECT_EQ(sut.readiness(false, std::nullopt), Readiness::kArmed);
  EXPECT_FALSE(sut.acts(1200, {}));
}

TEST(TrialArmingTest, ItCancelsInTheTrackingTrialAndItsRampsAlone) {
  const TrialArming sut = with(kTracking, {3, true});
  EXPECT_FALSE(sut.acts(899, {}));
  EXPECT_TRUE(sut.acts(900, {}));
  EXPECT_TRUE(sut.acts(1599, {}));
  EXPECT_FALSE(sut.acts(1600, {}));
  Trial pegged = kTracking;
  pegged.phase = TrialPhase::kPegged;
  EXPECT_FALSE(with(pegged, {3, true}).acts(1200, {}));
}

TEST(TrialArmingTest, AMitigatedTrialIsArmedWithItsOwnMitigationAlone) {
  const TrialArming sut = with(kTracking, {3, false, true});
  EXPECT_EQ(sut.newest(), 1);
  EXPECT_EQ(sut.readiness(true, std::nullopt), Readiness::kNoMitigation);
  EXPECT_EQ(sut.readiness(true, std::nullopt, PreparedParts{3}), Readiness::kNoMitigation);
  EXPECT_EQ(sut.readiness(false, std::nullopt, PreparedParts{1}), Readiness::kArmed);
}

TEST(TrialArmingTest, APartThatNeedsTheForceNeedsItsModelAsCancellationDoes) {
  const TrialArming sut = with(kTracking, {3, false, true, true});
  EXPECT_EQ(sut.readiness(false, std::nullopt, {1}), Readiness::kNoModel);
  EXPECT_EQ(sut.readiness(false, 1001, {1}), Readiness::kModelTooLate);
  EXPECT_EQ(sut.readiness(false, 1000, {1}), Readiness::kArmed);
  EXPECT_EQ(sut.readiness(true, std::nullopt, {1}), Readiness::kArmed);
  EXPECT_EQ(sut.readiness(true, std::nullopt), Readiness::kNoMitigation);
}

// A refused assignment must not run what was made of the one before, for the same trial.
TEST(TrialArmingTest, AnotherAssignmentOfTheSameTrialNeedsAMitigationOfItsOwn) {
  TrialArming sut = with(kTracking, {3, false, true});
  ASSERT_TRUE(sut.acts(1200, {1}));
  sut.assign({3, false, true});
  EXPECT_EQ(sut.newest(), 2);
  EXPECT_EQ(sut.readiness(true, std::nullopt, PreparedParts{1}), Readiness::kNoMitigation);
  EXPECT_FALSE(sut.acts(1200, {1}));
  EXPECT_EQ(sut.readiness(true, std::nullopt, PreparedParts{2}), Readiness::kArmed);
  EXPECT_TRUE(sut.acts(1200, {2}));
}

// It has to settle and fade in before the first measured tick; one that cannot does not act at all,
// so that no trial is mitigated in part.
TEST(TrialArmingTest, AMitigationThatComesTooLateIsNotArmedAndDoesNotAct) {
  TrialArming sut = with(kTracking, {3, false, true});
  EXPECT_EQ(sut.readiness(true, std::nullopt, {1, 1000}), Readiness::kArmed);
  EXPECT_TRUE(sut.acts(1200, {1, 1000}));
  EXPECT_EQ(sut.readiness(true, std::nullopt, {1, 1001}), Readiness::kMitigationTooLate);
  EXPECT_FALSE(sut.acts(1200, {1, 1001}));
  Trial later = kTracking;
  later.start_tick = 1001;
  sut.announce(later);
  EXPECT_EQ(sut.readiness(true, std::nullopt, {1, 1001}), Readiness::kArmed);
}

TEST(TrialArmingTest, AMitigationActsWithinTheTrialInPlaceOfCancellation) {
  const TrialArming sut = with(kTracking, {3, false, true});
  EXPECT_FALSE(sut.acts(899, {1}));
  EXPECT_TRUE(sut.acts(900, {1}));
  EXPECT_TRUE(sut.acts(1599, {1}));
  EXPECT_FALSE(sut.acts(1600, {1}));
  EXPECT_FALSE(sut.acts(1200, {0}));
  EXPECT_FALSE(sut.cancels());
  EXPECT_FALSE(with(kTracking, {2, false, true}).acts(1200, {1}));
  // Trial 0 is a session's pegged one, and 0 stands for none.
  Trial first = kTracking;
  first.number = 0;
  EXPECT_EQ(with(first, {0, false, true}).readiness(true, std::nullopt, PreparedParts{1}),
            Readiness::kNoMitigation);
}

}  // namespace
}  // namespace stillhand::cancellation::trial_arming_test
