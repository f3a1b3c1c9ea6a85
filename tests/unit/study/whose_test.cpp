// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/whose.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace stillhand::study::whose_test {
namespace {

using close_the_loop::Finding;

const Finding kFriction{"coulomb_friction", "omega", "drive", 1.0, 0, 0, ""};
const Finding kGrip{"nonlinear_stiffness", "", "body", 0.5, 0, 0, ""};

// Friction in all, the grip in those that are named.
std::map<std::string, PersonDiagnosis> people(int count, const std::vector<std::string>& gripping) {
  std::map<std::string, PersonDiagnosis> out;
  for (int n = 1; n <= count; ++n) {
    const std::string code = "P0" + std::to_string(n);
    out[code].findings = {kFriction};
    if (std::ranges::count(gripping, code) > 0) out[code].findings.push_back(kGrip);
  }
  return out;
}

// Binomial tails: 2^-5 = 0.031, 2^-4 = 0.063; of 0.8, P(at most 2 of 6) = 0.017, of 5 = 0.058.
TEST(WhoseTest, EverybodysIsTheRigsAndAFewPeoplesIsTheirs) {
  EXPECT_EQ(whose(6, 6), Whose::kRig);
  EXPECT_EQ(whose(5, 5), Whose::kRig);
  EXPECT_EQ(whose(4, 4), Whose::kOpen);
  EXPECT_EQ(whose(5, 6), Whose::kOpen);
  EXPECT_EQ(whose(2, 6), Whose::kPerson);
  EXPECT_EQ(whose(2, 5), Whose::kOpen);
  EXPECT_EQ(whose(1, 1), Whose::kOpen);
}

TEST(WhoseTest, WhoCouldNotShowTheEffectHasNoSay) {
  auto six = people(6, {"P02", "P05"});
  EXPECT_EQ(recurring_in(six)[1].able, 6u);
  for (const char* code : {"P01", "P03", "P04", "P06"}) six[code].detectable_body_n = 0.6;
  EXPECT_EQ(recurring_in(six)[1].able, 2u);
  EXPECT_EQ(recurring_in(six)[1].whose, Whose::kOpen);
}

TEST(WhoseTest, TheShareIsOfTheMeanSquareForce) {
  Diagnoses sut;
  sut.people = people(6, {"P02", "P05"});
  sut.recurring = recurring_in(sut.people);
  EXPECT_DOUBLE_EQ(share_of(sut, Whose::kRig), 6.0 / (6.0 + 2 * 0.25));
  EXPECT_DOUBLE_EQ(share_of(sut, Whose::kPerson), 0.5 / 6.5);
  EXPECT_DOUBLE_EQ(newcomers_chance(sut.recurring[0]), 7.0 / 8.0);
}

TEST(WhoseTest, TheOthersForecastWhatIsTheRigsAndNotWhatIsAPersons) {
  const auto sut = leave_one_out(people(6, {"P02", "P05"}));
  ASSERT_EQ(sut.size(), 6u);
  for (const LeftOutPerson& each : sut) {
    EXPECT_EQ(each.forecast, 1u);
    EXPECT_EQ(each.false_ones, 0u);
  }
  EXPECT_EQ(sut[1].found, 2u);
}

}  // namespace
}  // namespace stillhand::study::whose_test
