// SPDX-License-Identifier: Apache-2.0
#include "services/rig/digest.hpp"

#include <openssl/evp.h>

#include <array>
#include <random>
#include <stdexcept>

namespace stillhand::rig {
namespace {

std::string hexadecimal(const unsigned char* bytes, std::size_t size) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text += kDigits[bytes[i] >> 4];
    text += kDigits[bytes[i] & 15];
  }
  return text;
}

}  // namespace

std::string new_nonce() {
  std::random_device source;
  std::array<unsigned char, 16> bytes{};
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(source() & 0xffu);
  return hexadecimal(bytes.data(), bytes.size());
}

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 failed");
  }
  return hexadecimal(digest.data(), size);
}

std::string digest_line(const std::string& bytes, const std::string& name) {
  return sha256(bytes) + "  " + name + "\n";
}

}  // namespace stillhand::rig
