// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/text/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stillhand::report::text_test {

TEST(TextTest, HtmlKeepsNoCharacterThatOpensATagOrEndsAnAttribute) {
  EXPECT_EQ(html_escaped("<script>\"a\" & 'b'</script>"),
            "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/script&gt;");
}

TEST(TextTest, ALineBreakEndsNoGnuplotCommandAndWhatIsTakenLiterallyStays) {
  EXPECT_EQ(gnuplot_quoted("a\nset output 'x'\r\tb"), "'a set output ''x''  b'");
  EXPECT_EQ(gnuplot_quoted("$(x) `id` @m \\n %d m/s²"), "'$(x) `id` @m \\n %d m/s²'");
}

TEST(TextTest, LettersOfEveryLengthPassAndBytesThatAreNoXmlCharacterAreReplaced) {
  EXPECT_EQ(clean("a é ° θ ± − 𝛼"), "a é ° θ ± − 𝛼");
  EXPECT_EQ(clean("a\xFFz"), "a\uFFFDz");
  EXPECT_EQ(clean("\xC3"), "\uFFFD");                      // cut off
  EXPECT_EQ(clean("\xC0\xAF"), "\uFFFD\uFFFD");            // overlong '/'
  EXPECT_EQ(clean("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");  // a surrogate
  EXPECT_EQ(clean("\xEF\xBF\xBF"), "\uFFFD\uFFFD\uFFFD");  // U+FFFF
  EXPECT_EQ(clean(std::string_view("a\0b", 3)), "a b");    // NUL
  EXPECT_EQ(clean("\xC2\x85"
                  "x"),
            " x");  // U+0085, a control character
}

TEST(TextTest, ACellOfCsvIsQuotedOnlyWhereItMustBe) {
  EXPECT_EQ(csv_quoted("plain; 5' stick"), "plain; 5' stick");
  EXPECT_EQ(csv_quoted("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_quoted("5\" \"stick\""), "\"5\"\" \"\"stick\"\"\"");
  EXPECT_EQ(csv_quoted("a\r\nb"), "\"a\r\nb\"");
}

TEST(TextTest, WhatReplacesATextIsNotReplacedAgain) {
  std::string text = "aab";
  replace_all(text, "a", "aa");
  EXPECT_EQ(text, "aaaab");
}

TEST(TextTest, ScriptNumbersReadBackToNineDigits) {
  for (const double value : {0.0, -1.0 / 3.0, 1234567.89, 5e-7, 1e100, -2.5e-100}) {
    EXPECT_NEAR(std::stod(decimal(value)), value, 1e-8 * std::abs(value)) << decimal(value);
  }
}

TEST(TextTest, PeopleReadAMinusSignAndNeverMinusZero) {
  EXPECT_EQ(number(-3.14159, 2), "−3.14");
  EXPECT_EQ(number(-0.004, 2), "0.00");
  EXPECT_EQ(number(std::nan(""), 2), "–");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity(), 2), "–");
}

TEST(TextTest, ShortNumbersUsePowersOfTenOnlyForVeryLargeAndSmallOnes) {
  EXPECT_EQ(short_number(0.0), "0");
  EXPECT_EQ(short_number(0.2), "0.2");
  EXPECT_EQ(short_number(-12.25), "−12.2");
  EXPECT_EQ(short_number(1234.0), "1230");
  EXPECT_EQ(short_number(2e-5), "2×10⁻⁵");
  EXPECT_EQ(short_number(1e7), "10⁷");
  EXPECT_EQ(short_number(-1.5e12), "−1.5×10¹²");
  EXPECT_EQ(power_of_ten(1, -3), "10⁻³");  // without the factor of one
  EXPECT_EQ(power_of_ten(5, 10), "5×10¹⁰");
}

// Advance widths of DejaVu Sans 2.37 in units of 1/2048 em (its hmtx table): the font itself judges
// the estimate.  Never narrower than the font, or texts would overlap; at most 1.4 times as wide,
// or figures would be all margin.
TEST(TextTest, EstimatedWidthCoversTheFontsOwn) {
  struct Known {
    const char* text;
    double width_units;
  };
  for (const Known& known :
       {Known{"0.25", 3 * 1303 + 651.0}, Known{"−180", 1716 + 3 * 1303.0},
        Known{"model", 1995 + 1253 + 1300 + 1260 + 569.0}, Known{"WWW", 3 * 2025.0},
        Known{"fit", 721 + 569 + 803.0}, Known{"ABC", 1401 + 1405 + 1430.0},
        Known{"100 %", 3 * 1303 + 651 + 1946.0}}) {
    const double width_px = known.width_units / 2048.0 * 13.0;
    EXPECT_GE(text_width_px(known.text, 13.0), width_px) << known.text;
    EXPECT_LE(text_width_px(known.text, 13.0), width_px * 1.4) << known.text;
  }
}

TEST(TextTest, ARestoredShareHasItsIntervalOrSaysThatItHasNoneAndAWordOutsideOfZeroToOne) {
  EXPECT_EQ(restored(0.47, std::pair(0.3, 0.6)), "47 % [30, 60]");
  EXPECT_EQ(restored(0.47), "47 % (no interval)");
  EXPECT_EQ(restored(1.3, std::pair(0.9, 1.7)), "130 % [90, 170], better than A");
  EXPECT_EQ(restored(-0.2), "\u221220 % (no interval), worse than B");
}

}  // namespace stillhand::report::text_test
