// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/omgidl_tokens.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

namespace stillhand::recording::omgidl_tokens_test {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  for (const IdlToken& token : cut_idl(text).tokens) words.emplace_back(token.text);
  return words;
}

TEST(OmgIdlTokensTest, WordsNumbersTextsAndSignsAreTokens) {
  EXPECT_THAT(
      words_of("struct A_1{@key long x[0x1F];}"),
      ElementsAre("struct", "A_1", "{", "@", "key", "long", "x", "[", "0x1F", "]", ";", "}", ""));
  EXPECT_THAT(words_of("::a::b:c"), ElementsAre("::", "a", "::", "b", ":", "c", ""));
  EXPECT_THAT(words_of(R"(x="a \" // b";'\'')"),
              ElementsAre("x", "=", R"("a \" // b")", ";", R"('\'')", ""));
}

TEST(OmgIdlTokensTest, CommentsAndPreprocessorLinesAreNoTokens) {
  EXPECT_THAT(words_of("#include \"x.idl\"\na // b\n/* c\nd */ e"), ElementsAre("a", "e", ""));
  EXPECT_THAT(words_of(""), ElementsAre(""));
  EXPECT_THAT(words_of("// only a comment"), ElementsAre(""));
  EXPECT_THAT(words_of("/* not closed"), ElementsAre(""));
  EXPECT_THAT(words_of("\"not closed"), ElementsAre("\"not closed", ""));
  EXPECT_THAT(words_of("\"ends in a backslash\\"), ElementsAre("\"ends in a backslash\\", ""));
}

TEST(OmgIdlTokensTest, LinesAndColumnsCountFromOne) {
  const IdlTokens sut = cut_idl("a\n  b /* x\n y */ c\n");
  ASSERT_EQ(sut.tokens.size(), 4u);
  EXPECT_EQ(sut.tokens[0].line, 1u);
  EXPECT_EQ(sut.tokens[0].column, 1u);
  EXPECT_EQ(sut.tokens[1].line, 2u);
  EXPECT_EQ(sut.tokens[1].column, 3u);
  EXPECT_EQ(sut.tokens[2].line, 3u);
  EXPECT_EQ(sut.tokens[2].column, 7u);
  EXPECT_EQ(sut.tokens[3].line, 4u) << "the end of the text";
}

TEST(OmgIdlTokensTest, TheFirstCommentThatBeginsOnALineIsKept) {
  EXPECT_THAT(cut_idl("a // one // two\nb /* three */ c // four\n").comments,
              ElementsAre(Pair(1, " one // two"), Pair(2, " three */")));
}

TEST(OmgIdlTokensTest, TheUnitIsTheContentOfTheFirstBrackets) {
  EXPECT_EQ(unit_in(" [m/s^2] lateral [N]"), "m/s^2");
  EXPECT_EQ(unit_in("[-]"), "-");
  EXPECT_EQ(unit_in("[°]"), "°");
  EXPECT_EQ(unit_in("[123456789012345678901234]"), "") << "a number";
  EXPECT_EQ(unit_in("[abcdefghijklmnopqrstuvwx]"), "abcdefghijklmnopqrstuvwx") << "24 bytes";
  EXPECT_EQ(unit_in("[abcdefghijklmnopqrstuvwxy]"), "") << "25 bytes";
  for (const char* without : {"", "no brackets", "[open", "closed]", "] [", "[]", "[a\tb]"}) {
    EXPECT_EQ(unit_in(without), "") << without;
  }
}

// Tokens in order, apart and inside the text, whatever the text is.
TEST(OmgIdlTokensTest, EveryTextEndsInOneEmptyToken) {
  std::mt19937 random(17);
  const std::string alphabet = "a1_ \n/*\"'\\#:;{}[]@\t\xff";
  for (int round = 0; round < 5'000; ++round) {
    std::string text(random() % 30, ' ');
    for (char& c : text) c = alphabet[random() % alphabet.size()];
    const IdlTokens sut = cut_idl(text);
    ASSERT_FALSE(sut.tokens.empty());
    const char* behind = text.data();
    for (std::size_t i = 0; i < sut.tokens.size(); ++i) {
      const IdlToken& token = sut.tokens[i];
      ASSERT_EQ(token.text.empty(), i + 1 == sut.tokens.size()) << text;
      ASSERT_GE(token.text.data(), behind) << text;
      behind = token.text.data() + token.text.size();
    }
    ASSERT_LE(behind, text.data() + text.size()) << text;
  }
}

}  // namespace
}  // namespace stillhand::recording::omgidl_tokens_test
