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

// RFC 3629 "Syntax of UTF-8 Byte Sequences"; XML 1.0 "Char"; the controls of C0 and C1.
TEST(TextTest, ACharacterEndsWhereUtf8AndXmlEndIt) {
  const std::string_view first_and_last[]{" ",
                                          "~",
                                          "\xC2\xA0",
                                          "\xDF\xBF",
                                          "\xE0\xA0\x80",
                                          "\xED\x9F\xBF",
                                          "\xEE\x80\x80",
                                          "\xEF\xBF\xBD",
                                          "\xF0\x90\x80\x80",
                                          "\xF4\x8F\xBF\xBF"};
  for (const std::string_view good : first_and_last) EXPECT_EQ(clean(good), good);
  for (const std::string_view bad :
       {"\x80", "\xC1\xBF", "\xE0\x9F\xBF", "\xED\xBF\xBF", "\xEF\xBF\xBE", "\xF0\x8F\xBF\xBF",
        "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xF8\x80\x80\x80", "\xE2\x82"}) {
    std::string replaced;
    for (std::size_t i = 0; i < bad.size(); ++i) replaced += "\uFFFD";
    EXPECT_EQ(clean(bad), replaced);
  }
  EXPECT_EQ(clean("\xE2\x82(\xC3("), "\uFFFD\uFFFD(\uFFFD(") << "no byte of a sequence";
  for (const std::string_view control : {"\x1F", "\x7F", "\xC2\x80", "\xC2\x9F"}) {
    EXPECT_EQ(clean(control), " ");
  }
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
  EXPECT_EQ(number(-0.01, 2), "−0.01");
  EXPECT_EQ(number(-0.09, 2), "−0.09");
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
  EXPECT_EQ(short_number(-1e7), "−10⁷");
  EXPECT_EQ(short_number(1e-4), "0.0001");
  EXPECT_EQ(short_number(9.9e-5), "9.9×10⁻⁵");
  // Of three digits, 999499 is below a million and 999500 is not.
  EXPECT_EQ(short_number(-999499.0), "−999000");
  EXPECT_EQ(short_number(999500.0), "10⁶");
  EXPECT_EQ(short_number(1.25e6), "1.25×10⁶");
  EXPECT_EQ(short_number(-std::numeric_limits<double>::infinity()), "–");
  EXPECT_EQ(percent(0.125, 1), "12.5 %");
  EXPECT_EQ(p_value(0.0), "< 10⁻³⁰⁰");
  EXPECT_EQ(p_value(1e-300), "10⁻³⁰⁰");
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
        Known{"100 %", 3 * 1303 + 651 + 1946.0}, Known{"−", 1716.0}, Known{"+", 1716.0},
        Known{"A", 1401.0}, Known{"Z", 1403.0}, Known{"0", 1303.0}, Known{"f", 721.0}}) {
    const double width_px = known.width_units / 2048.0 * 13.0;
    EXPECT_GE(text_width_px(known.text, 13.0), width_px) << known.text;
    EXPECT_LE(text_width_px(known.text, 13.0), width_px * 1.4) << known.text;
  }
}

TEST(TextTest, ARestoredShareHasItsIntervalOrSaysThatItHasNoneAndAWordOutsideOfZeroToOne) {
  EXPECT_EQ(restored(0.47, std::pair(0.3, 0.6)), "47 % [30, 60]");
  EXPECT_EQ(restored(0.47), "47 % (no interval)");
  EXPECT_EQ(restored(1.3, std::pair(0.9, 1.7)), "130 % [90, 170], better than A");
  EXPECT_EQ(restored(1.0), "100 % (no interval)");
  EXPECT_EQ(restored(0.0), "0 % (no interval)");
  EXPECT_EQ(restored(-0.2), "\u221220 % (no interval), worse than B");
}

}  // namespace stillhand::report::text_test
