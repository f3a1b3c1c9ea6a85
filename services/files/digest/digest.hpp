// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace stillhand::digest {

/// 128 bits from the random source of the operating system, hexadecimal.
std::string new_nonce();

/// SHA-256 (FIPS 180-4), hexadecimal.
std::string sha256(const std::string& bytes);
/// Of a file of any size.  @throws std::runtime_error with the file, when it cannot be read
std::string sha256_of_file(const std::filesystem::path& path);
/// A line in the format of sha256sum.
std::string digest_line(const std::string& bytes, const std::string& name);

}  // namespace stillhand::digest
