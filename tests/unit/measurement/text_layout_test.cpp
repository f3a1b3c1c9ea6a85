// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/text_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::text_layout_test {

using testing::ElementsAre;
using testing::HasSubstr;

std::string error_of(std::string_view text, const TextForm& asked = {}) {
  return support::refusal([&] { (void)find_layout(text, asked, "ride.csv"); });
}

TEST(TextLayoutTest, SeparatorAndDecimalSignAreFound) {
  struct Case {
    const char* text;
    char separator;
    char decimal;
  };
  for (const Case& each :
       {Case{"t,a,f\n0.0,1.5,2\n0.1,1,2\n", ',', '.'},
        Case{"t;a;f\n0,0;1,5;2\n0,1;1;2\n", ';', ','},
        Case{"t;a;f\n0.0;1.5;2\n0.1;1;2\n", ';', '.'},
        Case{"t\ta\tf\n0,0\t1,5\t2\n0,1\t1\t2\n", '\t', ','},
        Case{"t\ta\tf\n0.0\t1.5\t2\n0.1\t1\t2\n", '\t', '.'},
        Case{"t a f\n  0.0   1.5 2\n  0.1 1 2\n", ' ', '.'}, Case{"t,a\n0,1\n1,2\n2,3\n", ',', '.'},
        Case{"t;a\n0;1\n1;2\n", ';', '.'}, Case{"t;a\n0,01;1,5\n0,02;1,5\n", ';', ','}}) {
    const TextLayout sut = find_layout(each.text, {}, "x");
    EXPECT_EQ(sut.form.separator, each.separator) << each.text;
    EXPECT_EQ(sut.form.decimal, each.decimal) << each.text;
    EXPECT_EQ(sut.first_line, 2u) << each.text;
  }
}

TEST(TextLayoutTest, WhatIsAskedForIsTaken) {
  // Two columns with a decimal point, or four whole numbers.
  const char* text = "a;b\n1.5;2\n1.25;3\n";
  EXPECT_EQ(find_layout(text, {';', 0}, "x").titles.size(), 2u);
  EXPECT_THAT(error_of(text, {'\t', 0}), HasSubstr("no rows of numbers"));
  EXPECT_EQ(find_layout("a;b\n1,5;2\n", {0, ','}, "x").form.separator, ';');
}

TEST(TextLayoutTest, CommentsAndAPreambleAreLeftOut) {
  const TextLayout sut = find_layout(
      "sep=;\n# made by a logger\nDevice: 4711\n\nDate;2024\n% another comment\n"
      "zeit;acc;kraft\n0,0;1,5;2\n0,1;1,5;2\n",
      {}, "x");
  EXPECT_THAT(sut.titles, ElementsAre("zeit", "acc", "kraft"));
  EXPECT_EQ(sut.first_line, 8u);
}

TEST(TextLayoutTest, ALineOfUnitsStandsBelowTheTitles) {
  const TextLayout sut = find_layout("t;acc;f\n[ms];[m/s²];[N]\n0;1,5;2\n1;1,5;2\n", {}, "x");
  EXPECT_THAT(sut.titles, ElementsAre("t", "acc", "f"));
  EXPECT_THAT(sut.units, ElementsAre("ms", "m/s²", "N"));
}

TEST(TextLayoutTest, TitlesMayStandInACommentOrBeMissing) {
  EXPECT_THAT(find_layout("# t, acc, f\n0,1.5,2\n1,1.5,2\n", {}, "x").titles,
              ElementsAre("t", "acc", "f"));
  EXPECT_THAT(find_layout("0,1.5,2\n1,1.5,2\n", {}, "x").titles,
              ElementsAre("column 1", "column 2", "column 3"));
  EXPECT_THAT(find_layout("t,,f\n0,1.5,2\n1,1.5,2\n", {}, "x").titles,
              ElementsAre("t", "column 2", "f"));
}

TEST(TextLayoutTest, ASeparatorInQuotesIsPartOfATitle) {
  EXPECT_THAT(find_layout("\"t\",\"acc, lateral\"\n0,1.5\n1,1.5\n", {}, "x").titles,
              ElementsAre("t", "acc, lateral"));
}

TEST(TextLayoutTest, TheFirstRowMayLackValues) {
  const TextLayout sut = find_layout("t,a,b,c\n0,,,5\n1,2,3,4\n2,2,3,4\n", {}, "x");
  EXPECT_EQ(sut.first_line, 2u);
}

TEST(TextLayoutTest, TitlesAtTheEndWithoutACellAreLeftOut) {
  for (const char* titles : {"X_Value\tacc\tforce\tComment", "t\ta\tf\t", "t\ta\tf\t\t\t"}) {
    const TextLayout sut =
        find_layout(std::string(titles) + "\n0.0\t1.5\t2\n0.1\t1.5\t2\n", {}, "x");
    EXPECT_EQ(sut.titles.size(), 3u) << titles;
    EXPECT_EQ(sut.first_line, 2u) << titles;
  }
}

TEST(TextLayoutTest, RowsMayEndWithASeparator) {
  for (const char* text :
       {"t,a,f\n0.0,1.5,2,\n0.1,1.5,2,\n", "t,a,f,\n0.0,1.5,2,\n0.1,1.5,2,\n",
        "t;a;f\n0,0;1,5;2;\n0,1;1,5;2;\n", "# t,a,f\n0.0,1.5,2,\n0.1,1.5,2,\n"}) {
    EXPECT_THAT(find_layout(text, {}, "x").titles, ElementsAre("t", "a", "f")) << text;
  }
  // A channel that has no value yet is one.
  EXPECT_THAT(find_layout("t,a,f\n0.0,1.5,\n0.1,1.5,\n", {}, "x").titles,
              ElementsAre("t", "a", "f"));
}

TEST(TextLayoutTest, ANumberAloneAboveTheTableIsNoRow) {
  for (const char* rate : {"100", "100.0", "Rate: 100 Hz", "100,"}) {
    const TextLayout sut =
        find_layout(std::string(rate) + "\nt,a,f\n0.0,1.5,2\n0.1,1.5,2\n0.2,1,2\n", {}, "x");
    EXPECT_THAT(sut.titles, ElementsAre("t", "a", "f")) << rate;
    EXPECT_EQ(sut.first_line, 3u) << rate;
  }
}

TEST(TextLayoutTest, TheDecimalSignMayShowBehindTheLinesLookedAtFirst) {
  std::string text = "t;a;f\n";
  for (int row = 0; row < 5000; ++row) text += std::to_string(row) + ";0;0\n";
  for (int row = 0; row < 5000; ++row) text += std::to_string(5000 + row) + ";0,5;1,25\n";
  EXPECT_EQ(find_layout(text, {}, "x").form.decimal, ',');
}

TEST(TextLayoutTest, DegreesAreStatedForAllAngles) {
  const std::string rows = "time\telbow\n0.0\t1.5\n0.1\t1.6\n";
  EXPECT_TRUE(find_layout("nRows=2\ninDegrees=yes\nendheader\n" + rows, {}, "x").in_degrees);
  EXPECT_TRUE(find_layout("In Degrees = Yes\n" + rows, {}, "x").in_degrees);
  EXPECT_FALSE(find_layout("inDegrees=no\n" + rows, {}, "x").in_degrees);
}

TEST(TextLayoutTest, SignsThatHideTheTableAreTheFault) {
  const char* text = "t,a\n0.0,1.5\n0.1,1.5\n";
  const std::string want =
      ", want ',' between columns and '.' as decimal sign, as the file has: leave --separator and "
      "--decimal out";
  EXPECT_EQ(error_of(text, {';', 0}),
            "ride.csv: got no rows of numbers with ';' between columns" + want);
  EXPECT_EQ(error_of(text, {0, ','}),
            "ride.csv: got no rows of numbers with ',' as decimal sign" + want);
  EXPECT_THAT(error_of("a letter\nof words\n", {';', 0}), HasSubstr("want a table: a line"));
}

TEST(TextLayoutTest, TooManyColumnsAreCounted) {
  std::string row = "0";
  for (int i = 0; i < 10'000; ++i) row += ",1";
  EXPECT_EQ(error_of(row + "\n" + row + "\n"), "ride.csv: got 10001 columns, want at most 10000");
}

TEST(TextLayoutTest, SaysWhatIsWrong) {
  EXPECT_THAT(error_of(""), HasSubstr("ride.csv: got an empty file"));
  EXPECT_THAT(error_of("Dear reader,\n\nthis is a letter.\n"), HasSubstr("no rows of numbers"));
  EXPECT_THAT(error_of("panel,x_axis,y_axis,series,x\n1,time [s],force [N],measured,0\n"),
              HasSubstr("got the data of a figure, want the recording"));
  // A comma within a title that has no quotes: whose cells these are is not known.
  EXPECT_THAT(error_of("t,force, lateral,acc\n0.0,1.5,2\n0.1,1.5,2\n"),
              HasSubstr("got 4 titles above rows of 3 cells"));
  // The decimal comma is the separator, too.
  EXPECT_THAT(error_of("t,f\n0,01,1,5\n0,02,1,5\n"),
              HasSubstr("ride.csv:1:1: got 2 titles above rows of 4 cells, with ',' between them"));
}

}  // namespace stillhand::measurement::text_layout_test
