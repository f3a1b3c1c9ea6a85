// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/access.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

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

// The length is no secret; the comparison takes a time that does not depend on the content.
bool is_secret(std::string_view word, const std::string& secret) {
  return !secret.empty() && word.size() == secret.size() &&
         CRYPTO_memcmp(word.data(), secret.data(), secret.size()) == 0;
}

bool is_of_own_page(const Access::Request& request) {
  const std::string host(request.host);
  return request.origin.empty() || request.origin == "http://" + host ||
         request.origin == "https://" + host;
}

std::string random_word() {
  std::array<unsigned char, 32> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw std::runtime_error("OpenSSL gives no random numbers");
  }
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

}  // namespace

Access::Access(std::string token, std::string watch_token)
    : token_(std::move(token)),
      watch_token_(std::move(watch_token)),
      cookie_(token_.empty() ? "" : random_word()),
      watch_cookie_(watch_token_.empty() ? "" : random_word()) {}

Access::Role Access::role_of_token(std::string_view word) const {
  if (is_secret(word, token_)) return Role::kActing;
  return is_secret(word, watch_token_) ? Role::kWatching : Role::kNobody;
}

Access::Role Access::role_of(const Request& request) const {
  if (token_.empty()) {
    constexpr std::array<std::string_view, 3> kLoopback{"127.0.0.1", "localhost", "[::1]"};
    const bool here = std::ranges::find(kLoopback, name_of(request.host)) != kLoopback.end();
    return here ? Role::kActing : Role::kNobody;
  }
  if (request.authorization.starts_with(kBearer)) {
    return role_of_token(request.authorization.substr(kBearer.size()));
  }
  const std::string_view shown = value_behind(request.cookie, cookie_key(request.host), ';');
  if (is_secret(shown, cookie_)) return Role::kActing;
  return is_secret(shown, watch_cookie_) ? Role::kWatching : Role::kNobody;
}

bool Access::signs_in(const Request& request) const {
  return role_of_token(value_behind(request.query, kQuery, '&')) != Role::kNobody;
}

bool Access::allows(const Request& request) const { return role_of(request) != Role::kNobody; }

bool Access::only_watches(const Request& request) const {
  return role_of(request) == Role::kWatching;
}

bool Access::allows_change(const Request& request) const {
  return role_of(request) == Role::kActing && is_of_own_page(request);
}

bool Access::allows_emergency_stop(const Request& request) const {
  return allows(request) && is_of_own_page(request);
}

std::string Access::cookie(const Request& request) const {
  const bool acts = role_of_token(value_behind(request.query, kQuery, '&')) == Role::kActing;
  return cookie_key(request.host) + (acts ? cookie_ : watch_cookie_) +
         "; Path=/; HttpOnly; SameSite=Strict";
}

std::string read_token(const std::string& option, const std::string& file) {
  struct stat about{};
  if (stat(file.c_str(), &about) == 0) {
    if (!S_ISREG(about.st_mode)) {
      throw ConfigError(option + " " + file, "not a regular file", "a file with a token");
    }
    if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
      throw ConfigError(option + " " + file, "a file that other users can read", "mode 600");
    }
  }
  std::string token = recording::read_file(file);
  while (!token.empty() && (token.back() == '\n' || token.back() == '\r')) token.pop_back();
  const bool plain = std::ranges::all_of(token, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (token.size() < kShortest || token.size() > kLongest || !plain) {
    throw ConfigError(option + " " + file, std::to_string(token.size()) + " characters",
                      "one line of 16 to 256 letters, digits, '-', '_' and '.', for example from "
                      "`openssl rand -hex 32`");
  }
  return token;
}

}  // namespace stillhand::dashboard
