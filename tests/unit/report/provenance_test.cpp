// SPDX-License-Identifier: Apache-2.0
// Where a result came from: written, read back, in words.
#include "apps/libraries/report/provenance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/libraries/report/command_line.hpp"
#include "services/files/digest/content_digest.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::report::provenance_test {

using nlohmann::ordered_json;
using testing::HasSubstr;

const Provenance kMade{"0.1.0",
                       "2026-11-26T13:50:00Z",
                       "stillhand diagnose ride.csv",
                       {{"ride.csv", std::string(64, 'a')}, {"/dev/stdin", ""}}};

TEST(ProvenanceTest, TheTextKeepsItsEntriesInOrderAndEveryBit) {
  const std::string text = with_provenance(R"({"b":0.1,"a":[1,2.5e-300]})", kMade);
  const ordered_json sut = ordered_json::parse(text);
  EXPECT_EQ(sut.begin().key(), "b");
  EXPECT_EQ(sut["b"], 0.1);
  EXPECT_EQ(sut["a"][1], 2.5e-300);
  EXPECT_EQ(sut["provenance"]["sources"][0]["name"], "ride.csv");
  EXPECT_TRUE(sut["provenance"]["sources"][1]["sha256"].is_null());
}

TEST(ProvenanceTest, ItComesBackAndIsOneLine) {
  const auto sut = provenance_in(with_provenance("{}", kMade));
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->date, kMade.date);
  EXPECT_EQ(sut->sources[0].sha256, kMade.sources[0].sha256);
  EXPECT_EQ(in_words(*sut),
            "stillhand 0.1.0, 2026-11-26T13:50:00Z, from ride.csv (SHA-256 aaaaaaaaaaaa), "
            "/dev/stdin: stillhand diagnose ride.csv");
}

TEST(ProvenanceTest, ATextWithoutOneOrWithAnotherTypeHasNone) {
  for (const char* text :
       {"{}", "[]", "no JSON", R"({"provenance":7})", R"({"provenance":{"version":1}})"}) {
    EXPECT_FALSE(provenance_in(text).has_value()) << text;
  }
}

TEST(ProvenanceTest, TheTimeIsUtc) {
  EXPECT_EQ(utc(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(utc(1'000'000'000), "2001-09-09T01:46:40Z");
}

// The digest of three bytes, "abc", is FIPS 180-4's own example.
TEST(ProvenanceTest, ThisCallHasItsSourcesDigestsAndTheDateItIsGiven) {
  const support::Folder folder;
  const auto path = folder / "abc";
  std::ofstream(path) << "abc";
  ::setenv("SOURCE_DATE_EPOCH", "1000000000", 1);
  const Provenance sut = provenance_of_this_call({path, "/dev/null"});
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_EQ(sut.date, "2001-09-09T01:46:40Z");
  EXPECT_EQ(sut.sources[0].sha256,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sut.sources[0].name, path.string());
  EXPECT_EQ(sut.sources[1].sha256, "") << "no plain file";
  EXPECT_FALSE(sut.version.empty());
}

TEST(CommandLineTest, AWordIsQuotedWhereAShellWouldReadMore) {
  EXPECT_EQ(quoted_for_shell("ride.csv"), "ride.csv");
  EXPECT_EQ(quoted_for_shell("time=t [s]"), "'time=t [s]'");
  EXPECT_EQ(quoted_for_shell("it's"), "'it'\\''s'");
  EXPECT_EQ(quoted_for_shell(""), "''");
}

TEST(CommandLineTest, ItIsThisProgramsCall) {
  EXPECT_THAT(command_line(), testing::StartsWith("stillhand"));
}

TEST(ProvenanceTest, AHandThatChangesANumberIsNoticed) {
  const std::string text =
      with_provenance(R"({"gain": 1.5, "list": [1, 2.25]})", {"1.0", "", "", {}});
  digest::require_as_written(text, "m.json");
  digest::require_as_written(nlohmann::ordered_json::parse(text).dump(), "m.json");  // white space
  std::string changed = text;
  changed.replace(changed.find("2.25"), 4, "2.75");
  EXPECT_THAT(support::refusal([&] { digest::require_as_written(changed, "m.json"); }),
              testing::HasSubstr("m.json: got a file that was changed after it was written"));
  digest::require_as_written(R"({"gain": 1.5})", "of an older version");
  // A result that is made from another one has its own.
  digest::require_as_written(with_provenance(changed, {"1.0", "", "", {}}), "m.json");
}

}  // namespace stillhand::report::provenance_test
