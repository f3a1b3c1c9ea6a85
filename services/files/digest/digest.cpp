// SPDX-License-Identifier: Apache-2.0
#include "services/files/digest/digest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <random>
#include <span>
#include <stdexcept>
#include <vector>

namespace stillhand::digest {
namespace {

std::string hexadecimal(std::span<const unsigned char> bytes) {
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

}  // namespace

std::string new_nonce() {
  std::random_device source;
  std::array<unsigned char, 16> bytes{};
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(source() & 0xffu);
  return hexadecimal(bytes);
}

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 failed");
  }
  return hexadecimal({digest.data(), size});
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> state(EVP_MD_CTX_new(),
                                                                      &EVP_MD_CTX_free);
  std::ifstream file(path, std::ios::binary);
  bool good = state && EVP_DigestInit_ex(state.get(), EVP_sha256(), nullptr) == 1;
  std::vector<char> piece(1 << 16);
  while (good && file) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    good =
        EVP_DigestUpdate(state.get(), piece.data(), static_cast<std::size_t>(file.gcount())) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (!good || !file.eof() || EVP_DigestFinal_ex(state.get(), digest.data(), &size) != 1) {
    throw std::runtime_error(path.string() + ": cannot be read for its SHA-256");
  }
  return hexadecimal({digest.data(), size});
}

std::string digest_line(const std::string& bytes, const std::string& name) {
  return sha256(bytes) + "  " + name + "\n";
}

}  // namespace stillhand::digest
