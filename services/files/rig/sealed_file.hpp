// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "services/core/rig/undeclared/sealed_effect.hpp"
#include "services/files/digest/digest.hpp"

namespace stillhand::rig {

inline constexpr const char* kSealedFile = "undeclared_effect.json";
inline constexpr const char* kCommitmentFile = "undeclared_effect.sha256";

/// Seed of the effect; only the process of the rig receives it.
struct SealedSeed {
  std::uint64_t seed;
  std::string nonce;  ///< hexadecimal; prevents a search over seeds for the digest
};

/// Reads one line "SEED NONCE".  @throws ConfigError for any other text.
SealedSeed read_sealed_seed(std::istream& from);
/// The line that read_sealed_seed() reads.
std::string text_of(const SealedSeed& sealed);

/// Content of undeclared_effect.json; README, "The sealed file".
std::string sealed_text(const OpenedEffect& effect, const std::string& nonce);

/// Writes the digest of the sealed text, before the session.
/// @throws std::runtime_error with the file that could not be written.
void commit_effect(const std::filesystem::path& folder, const std::string& sealed_text);
/// Opens the effect after the verdict: adds the digest of the verdict to the commitment, then
/// writes the sealed text.
/// @param verdict_file  a file of the same folder; empty: no verdict
/// @throws ConfigError if the verdict cannot be read or the commitment belongs to another text;
///         std::runtime_error with the file that could not be written.
void open_effect(const std::filesystem::path& folder, const std::string& sealed_text,
                 const std::string& verdict_file);

}  // namespace stillhand::rig
