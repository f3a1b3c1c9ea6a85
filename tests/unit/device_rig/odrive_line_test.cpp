// SPDX-License-Identifier: Apache-2.0
// Eq. DR-30.  Judges: what the maker prints.  odriverobotics/ODrive at a5f4efe,
// docs/ascii-protocol.md
// ("r vbus_voltage *93"), and its issue 596 ("48.065918*33").
#include "services/core/device_rig/odrive_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace stillhand::device_rig::odrive {
namespace {

TEST(OdriveLinesTest, AQuestionIsTheLineThatTheMakerPrints) {
  Lines sut;
  sut.add("r vbus_voltage");
  EXPECT_EQ(sut.view(), "r vbus_voltage *93\n");
}

TEST(OdriveLinesTest, TheMakersPrintedAnswerIsRead) {
  const auto text = read_line("48.065918*33");
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, "48.065918");
  EXPECT_EQ(real_of(*text), 48.065918);
}

TEST(OdriveLinesTest, AnAnswerWithoutOrWithAWrongChecksumIsNone) {
  for (const char* wrong : {"24.087744", "48.065918*34", "48.165918*33", "48.065918*", "*", "",
                            "48.065918*33 ", "48.065918*-33"}) {
    EXPECT_FALSE(read_line(wrong)) << wrong;
  }
}

TEST(OdriveLinesTest, ACommandHasItsValueAndTheChecksumOfAllBeforeTheStar) {
  Lines sut;
  sut.add("c 0 ", -0.25);
  sut.add("w test_property ", std::uint64_t{1000});
  EXPECT_TRUE(sut.good());
  // c ^ 0 ^ - ^ . ^ 2 ^ 5, the rest in pairs: the zeros but one, and the blanks but one.
  constexpr int kSum = 'c' ^ '-' ^ '.' ^ '2' ^ '5' ^ ' ';
  EXPECT_EQ(sut.view().substr(0, sut.view().find('\n')), "c 0 -0.250000 *" + std::to_string(kSum));
  EXPECT_NE(sut.view().find("\nw test_property 1000 *"), std::string_view::npos);
}

TEST(OdriveLinesTest, WhatDoesNotFitIsLeftOutAsAWhole) {
  Lines sut;
  for (int i = 0; i < 100; ++i) sut.add("r axis0.current_state");
  EXPECT_FALSE(sut.good());
  EXPECT_EQ(sut.view().back(), '\n');
}

TEST(OdriveLinesTest, ANumberIsTheWholeText) {
  EXPECT_EQ(whole_of("8"), 8u);
  EXPECT_EQ(real_of("-0.5"), -0.5);
  EXPECT_TRUE(std::isinf(real_of("inf").value_or(0.0)));
  for (const char* none : {"", "8 ", " 8", "8.0", "-8", "invalid property", "0x8"}) {
    EXPECT_FALSE(whole_of(none)) << none;
  }
}

}  // namespace
}  // namespace stillhand::device_rig::odrive
