// SPDX-License-Identifier: Apache-2.0
#include "services/files/rig/sealed_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::rig::sealed_file_test {
namespace {

class SealedFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::string content(const char* name) const {
    return support::text_of(folder / name);
  }

  const support::Folder folder;
  const std::string nonce = "00112233445566778899aabbccddeeff";
  const OpenedEffect effect{41, "tone", "", "hand", {{"amplitude", "N", 1.5}}};
};

// FIPS 180-4's example of one block.
TEST_F(SealedFileTest, DigestIsSha256) {
  EXPECT_EQ(digest::sha256("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_F(SealedFileTest, TextHoldsTheWholeTruth) {
  const auto json = nlohmann::json::parse(sealed_text(effect, nonce));
  EXPECT_EQ(json["seed"], 41);
  EXPECT_EQ(json["kind"], "tone");
  EXPECT_TRUE(json["channel"].is_null());
  EXPECT_EQ(json["place"], "hand");
  EXPECT_EQ(json["parameters"]["amplitude"]["value"], 1.5);
  EXPECT_EQ(json["parameters"]["amplitude"]["unit"], "N");
  EXPECT_EQ(json["nonce"], nonce);
}

TEST_F(SealedFileTest, CommitmentComesFirstAndHoldsNothingButTheDigest) {
  const std::string text = sealed_text(effect, nonce);
  commit_effect(folder, text);
  EXPECT_EQ(content(kCommitmentFile), digest::sha256(text) + "  undeclared_effect.json\n");
  EXPECT_FALSE(std::filesystem::exists(folder / kSealedFile));
  open_effect(folder, text, "");
  EXPECT_EQ(content(kSealedFile), text);
}

TEST_F(SealedFileTest, TheVerdictIsWrittenDownBeforeTheTruth) {
  const std::string text = sealed_text(effect, nonce);
  commit_effect(folder, text);
  EXPECT_THROW(open_effect(folder, text, "verdict.json"), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(folder / kSealedFile));
  std::ofstream(folder / "verdict.json") << "abc";
  open_effect(folder, text, "verdict.json");
  EXPECT_EQ(content(kCommitmentFile),
            digest::digest_line(text, kSealedFile) + digest::digest_line("abc", "verdict.json"));
  EXPECT_EQ(content(kSealedFile), text);
}

TEST_F(SealedFileTest, AnotherTruthThanTheCommittedOneIsRefused) {
  commit_effect(folder, sealed_text(effect, nonce));
  OpenedEffect other = effect;
  other.kind = "delay";
  EXPECT_THROW(open_effect(folder, sealed_text(other, nonce), ""), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(folder / kSealedFile));
}

TEST_F(SealedFileTest, SeedAndNonceComeBackAndAnythingElseIsRefused) {
  std::istringstream good(text_of({12345678901234u, nonce}));
  const SealedSeed read = read_sealed_seed(good);
  EXPECT_EQ(read.seed, 12345678901234u);
  EXPECT_EQ(read.nonce, nonce);
  for (const char* bad : {"", "12", "x 00112233445566778899aabbccddeeff", "3 0011"}) {
    std::istringstream input(bad);
    EXPECT_THROW(read_sealed_seed(input), ConfigError) << bad;
  }
}

TEST_F(SealedFileTest, NoncesDiffer) {
  EXPECT_EQ(digest::new_nonce().size(), 32u);
  EXPECT_NE(digest::new_nonce(), digest::new_nonce());
}

}  // namespace
}  // namespace stillhand::rig::sealed_file_test
