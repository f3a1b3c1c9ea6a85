// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/access.hpp"

#include <openssl/crypto.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "services/contract/config_error.hpp"
#include "services/recording/file_io.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::string_view kCookie = "stillhand_token";
constexpr std::string_view kBearer = "Bearer ";
constexpr std::string_view kQuery = "token=";
constexpr std::size_t kShortest = 16, kLongest = 256;

/// Host without its port.
std::string_view name_of(std::string_view host) {
  if (host.starts_with('[')) return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

/// "stillhand_token_8340=" for "lab:8340"; it goes into a header, so of a port only digits do.
std::string cookie_key(std::string_view host) {
  const std::string_view port = host.substr(name_of(host).size());
  const bool digits = port.size() > 1 && std::ranges::all_of(port.substr(1), [](char c) {
                        return c >= '0' && c <= '9';
                      });
  return std::string(kCookie) + (digits ? "_" + std::string(port.substr(1)) : "") + "=";
}

/// Value of the first "<key>value" between separators.
std::string_view value_behind(std::string_view text, std::string_view key, char separator) {
  while (!text.empty()) {
    std::string_view part = text.substr(0, text.find(separator));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    while (part.starts_with(' ')) part.remove_prefix(1);
    if (part.starts_with(key)) return part.substr(key.size());
  }
  return {};
}

}  // namespace

bool Access::is_token(std::string_view word) const {
  // The length is no secret; the comparison takes a time that does not depend on the content.
  return !token_.empty() && word.size() == token_.size() &&
         CRYPTO_memcmp(word.data(), token_.data(), token_.size()) == 0;
}

bool Access::signs_in(const Request& request) const {
  return is_token(value_behind(request.query, kQuery, '&'));
}

bool Access::allows(const Request& request) const {
  if (token_.empty()) {
    constexpr std::array<std::string_view, 3> kLoopback{"127.0.0.1", "localhost", "[::1]"};
    return std::ranges::find(kLoopback, name_of(request.host)) != kLoopback.end();
  }
  if (request.authorization.starts_with(kBearer)) {
    return is_token(request.authorization.substr(kBearer.size()));
  }
  return is_token(value_behind(request.cookie, cookie_key(request.host), ';'));
}

bool Access::allows_change(const Request& request) const {
  if (!allows(request)) return false;
  return request.origin.empty() || request.origin == "http://" + std::string(request.host) ||
         request.origin == "https://" + std::string(request.host);
}

std::string Access::cookie(const Request& request) const {
  return cookie_key(request.host) + token_ + "; Path=/; HttpOnly; SameSite=Strict";
}

std::string read_token(const std::string& file) {
  struct stat about {};
  if (stat(file.c_str(), &about) == 0) {
    if (!S_ISREG(about.st_mode)) {
      throw ConfigError("--token-file " + file, "not a regular file", "a file with a token");
    }
    if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
      throw ConfigError("--token-file " + file, "a file that other users can read", "mode 600");
    }
  }
  std::string token = recording::read_file(file);
  while (!token.empty() && (token.back() == '\n' || token.back() == '\r')) token.pop_back();
  const bool plain = std::ranges::all_of(token, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (token.size() < kShortest || token.size() > kLongest || !plain) {
    throw ConfigError("--token-file " + file, std::to_string(token.size()) + " characters",
                      "one line of 16 to 256 letters, digits, '-', '_' and '.', for example from "
                      "`openssl rand -hex 32`");
  }
  return token;
}

}  // namespace stillhand::dashboard
