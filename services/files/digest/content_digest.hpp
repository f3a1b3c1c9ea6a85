// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace stillhand::digest {

/// Entries of a file's provenance that the two below write and read.
inline constexpr const char* kProvenance = "provenance";
inline constexpr const char* kContentDigest = "content_sha256";

/// SHA-256 of what a JSON object holds next to its provenance; white space does not count.
std::string content_digest(nlohmann::ordered_json whole);

/// A changed number is still a number, and what it predicts looks right.  Files of older versions
/// have no digest, and pass.
/// @param json  of an object  @param origin  its path
/// @throws stillhand::ConfigError where the content is not the one that the digest was made of
void require_as_written(std::string_view json, const std::string& origin);

}  // namespace stillhand::digest
