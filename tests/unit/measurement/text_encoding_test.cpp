// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/text_encoding.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/refusal.hpp"

namespace stillhand::measurement::text_encoding_test {

using namespace std::string_literals;

// Each character as two bytes.
std::string wide(const std::string& text, bool low_first) {
  std::string bytes;
  for (const char c : text) bytes += low_first ? ""s + c + '\0' : '\0' + ""s + c;
  return bytes;
}

std::string note_of(const std::string& bytes) { return to_utf8(bytes, "f.csv").note; }
std::string refused(const std::string& bytes) {
  return support::refusal([&] { (void)to_utf8(bytes, "f.csv"); });
}

// RFC 3629, section 4: the first and the last character of each length, and those next to what is
// left out.
TEST(TextEncodingTest, Utf8IsTakenAsItIs) {
  for (const std::string text :
       {"\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80",
        "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "t,\xC2\xB0,\xE2\x82\xAC,1"}) {
    const DecodedText sut = to_utf8(text, "f.csv");
    EXPECT_EQ(sut.text, text);
    EXPECT_EQ(sut.note, "");
  }
}

// A lead that is none, a character that is cut off or goes on wrongly, overlong ones, a surrogate,
// and what is beyond U+10FFFF.
TEST(TextEncodingTest, WhatIsNoUtf8IsReadAsWindows1252) {
  for (const std::string text :
       {"\xBF", "\xC1\xBF", "\xF5\x80\x80\x80", "\xC2", "\xE2\x82", "\xF0\x90\x80", "\xC2\x41",
        "\xC2\xC0", "\xE2\x82\x41", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF",
        "\xF4\x90\x80\x80"}) {
    if (text.find_first_of("\x81\x8D\x8F\x90\x9D") == std::string::npos) {
      EXPECT_EQ(note_of(text), "Text in WINDOWS-1252.") << text.size();
    } else {  // bytes that Windows-1252 leaves open
      EXPECT_EQ(refused(text), "f.csv: got text that is no WINDOWS-1252, want text in UTF-8");
    }
  }
  EXPECT_EQ(to_utf8("\xB0"
                    "C,\x80",
                    "f.csv")
                .text,
            "\xC2\xB0"
            "C,\xE2\x82\xAC");
}

TEST(TextEncodingTest, AMarkOrAZeroAsEachSecondByteShowsTwoBytesACharacter) {
  const std::string text = "t,y\n1,2\n";
  EXPECT_EQ(to_utf8(wide(text, true), "").text, text);
  EXPECT_EQ(to_utf8(wide(text, false), "").text, text);
  EXPECT_EQ(to_utf8("\xFF\xFE" + wide(text, true), "").text, text);
  EXPECT_EQ(to_utf8("\xFE\xFF" + wide(text, false), "").text, text);
  EXPECT_EQ(note_of(wide(text, true)), "Text in UTF-16LE.");
  EXPECT_EQ(note_of(wide(text, false)), "Text in UTF-16BE.");
  std::string four = "\xFF\xFE\0\0"s;
  for (const char c : text) four += ""s + c + "\0\0\0"s;
  EXPECT_EQ(to_utf8(four, "").text, text);
  EXPECT_EQ(note_of(four), "Text in UTF-32.");
  // More than two fifths of the bytes.
  EXPECT_EQ(note_of(wide("aaaaa", true) + "bb"), "Text in UTF-16LE.");
  EXPECT_EQ(note_of(wide("aaaaa", false) + "bb"), "Text in UTF-16BE.");
  EXPECT_EQ(refused(wide("aaaaa", true) + "bbbb"),
            "f.csv: got binary data, want a text table (CSV), or MATLAB, HDF5, MCAP or WAV");
}

TEST(TextEncodingTest, ZerosAreLeftOutAtTheEndAndRefusedElsewhere) {
  const DecodedText sut = to_utf8("t\n1\n\0\0\0"s, "f.csv");
  EXPECT_EQ(sut.text, "t\n1\n");
  EXPECT_EQ(sut.note, "3 zero bytes at the end are left out.");
  EXPECT_EQ(note_of("t,\xB0\n\0"s), "Text in WINDOWS-1252. 1 zero bytes at the end are left out.");
  EXPECT_EQ(refused("t\n1\n2\0x"s).substr(0, 24), "f.csv:3: got binary data");
  EXPECT_EQ(refused("\0\0\0"s).substr(0, 22), "f.csv: got binary data");
}

TEST(TextEncodingTest, SignsOfABlankAMinusAndALineAreMadePlain) {
  EXPECT_EQ(to_utf8("1\u00A0000\u202F0\u2007\u2009,\u22122\uFEFF", "").text, "1 000 0  ,-2");
  EXPECT_EQ(to_utf8("t\r1\r", "").text, "t\n1\n");
  EXPECT_EQ(to_utf8("t\r\n1\r\n", "").text, "t\r\n1\r\n");
  EXPECT_EQ(to_utf8("", "").text, "");
}

}  // namespace stillhand::measurement::text_encoding_test
