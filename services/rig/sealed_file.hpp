// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "services/rig/core/undeclared/sealed_effect.hpp"

namespace stillhand::rig {

inline constexpr const char* kSealedFile = "undeclared_effect.json";
inline constexpr const char* kCommitmentFile = "undeclared_effect.sha256";

/// What the rig's process is told of its effect, and nobody else.
struct SealedSeed {
  std::uint64_t seed;
  std::string nonce;  ///< hexadecimal; without it a commitment could be tried out seed by seed
};

/// 128 bits from the system's random source, hexadecimal.
std::string new_nonce();

/// "SEED NONCE", one line.  @throws ConfigError for anything else.
SealedSeed read_sealed_seed(std::istream& from);
/// The same as text.
std::string text_of(const SealedSeed& sealed);

/// undeclared_effect.json, byte for byte: README, "The sealed file".
std::string sealed_text(const OpenedEffect& effect, const std::string& nonce);

/// SHA-256 (FIPS 180-4), hexadecimal.
std::string sha256(const std::string& bytes);
/// A line as sha256sum writes and checks it.
std::string digest_line(const std::string& bytes, const std::string& name);

/// Before the session: the digest of a text that nobody has yet.
/// @throws std::runtime_error which file could not be written.
void commit_effect(const std::filesystem::path& folder, const std::string& sealed_text);
/// After the verdict: first the verdict's digest beside the commitment (a file of the same folder,
/// or empty: there is none), then the text.
/// @throws ConfigError when the verdict can't be read or the commitment is of another text;
///         std::runtime_error which file could not be written.
void open_effect(const std::filesystem::path& folder, const std::string& sealed_text,
                 const std::string& verdict_file);

}  // namespace stillhand::rig
