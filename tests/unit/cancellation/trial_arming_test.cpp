// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/trial_arming.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace stillhand::cancellation::trial_arming_test {
namespace {

constexpr Trial kTracking{3, TrialPhase::kTracking, 1000, 500, 100};

TrialArming with(const Trial& trial, const Assignment& assignment) {
  TrialArming sut;
  sut.announce(trial);
  sut.assign(assignment);
  return sut;
}

TEST(TrialArmingTest, TrialAndAssignmentComeInEitherOrder) {
  TrialArming sut;
  EXPECT_FALSE(sut.acts(0, {}));
  EXPECT_EQ(sut.readiness(true, {}), Readiness::kUnassigned);
  sut.assign({3, true});
  EXPECT_EQ(sut.readiness(true, {}), Readiness::kUnassigned);
  sut.announce(kTracking);
  EXPECT_EQ(sut.readiness(true, {}), Readiness::kArmed);
  EXPECT_TRUE(sut.acts(1200, {}));
}

TEST(TrialArmingTest, ATrialIsArmedWithWhatItsAssignmentNeeds) {
  constexpr Assignment kOther{2, true}, kPlain{3, false}, kCancelled{3, true};
  constexpr Assignment kParts{3, false, true}, kForceParts{3, false, true, true};
  const struct {
    std::optional<Assignment> assignment;
    bool has_model;
    std::optional<Tick> next_model;
    PreparedParts prepared;
    Readiness wanted;
    bool acts;
  } cases[]{{{}, true, {}, {}, Readiness::kUnassigned, false},
            {kOther, true, {}, {}, Readiness::kUnassigned, false},
            {kPlain, false, {}, {}, Readiness::kArmed, false},
            {kCancelled, false, {}, {}, Readiness::kNoModel, true},
            {kCancelled, false, 1000, {}, Readiness::kArmed, true},  // its first measured tick
            {kCancelled, false, 1001, {}, Readiness::kModelTooLate, true},
            {kCancelled, true, 1001, {}, Readiness::kArmed, true},  // with the one in use
            {kParts, true, {}, {}, Readiness::kNoMitigation, false},
            {kParts, true, {}, {3}, Readiness::kNoMitigation, false},
            {kParts, false, {}, {1}, Readiness::kArmed, true},
            {kForceParts, false, {}, {1}, Readiness::kNoModel, true},
            {kForceParts, false, 1001, {1}, Readiness::kModelTooLate, true},
            {kForceParts, false, 1000, {1}, Readiness::kArmed, true},
            {kForceParts, true, {}, {1}, Readiness::kArmed, true},
            {kForceParts, true, {}, {}, Readiness::kNoMitigation, false}};
  for (const auto& each : cases) {
    TrialArming sut;
    sut.announce(kTracking);
    if (each.assignment) sut.assign(*each.assignment);
    EXPECT_EQ(sut.readiness(each.has_model, each.next_model, each.prepared), each.wanted)
        << &each - cases;
    EXPECT_EQ(sut.acts(1200, each.prepared), each.acts) << &each - cases;
  }
}

TEST(TrialArmingTest, ItCancelsInTheTrackingTrialAndItsRampsAlone) {
  const TrialArming sut = with(kTracking, {3, true});
  EXPECT_FALSE(sut.begun(899));
  EXPECT_TRUE(sut.begun(900));
  EXPECT_FALSE(with(kTracking, {2, true}).begun(1200));
  EXPECT_FALSE(sut.acts(899, {}));
  EXPECT_TRUE(sut.acts(900, {}));
  EXPECT_TRUE(sut.acts(1599, {}));
  EXPECT_FALSE(sut.acts(1600, {}));
  Trial pegged = kTracking;
  pegged.phase = TrialPhase::kPegged;
  EXPECT_FALSE(with(pegged, {3, true}).acts(1200, {}));
}

// A refused assignment must not run what was made of the one before, for the same trial.
TEST(TrialArmingTest, AnotherAssignmentOfTheSameTrialNeedsAMitigationOfItsOwn) {
  TrialArming sut = with(kTracking, {3, false, true});
  EXPECT_EQ(sut.newest(), 1);
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
