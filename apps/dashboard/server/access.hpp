// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace stillhand::dashboard {

/// Decides which requests may see the page.  Without a token: requests that name the host as a
/// loopback address, since otherwise a page of another site could reach this one through a host
/// name of its own ("DNS rebinding").  With a token: requests that show it.
class Access {
 public:
  /// @param token  empty: loopback
  explicit Access(std::string token) : token_(std::move(token)) {}

  /// The parts of a request that decide; empty if missing.
  struct Request {
    std::string_view host, origin, authorization, cookie;
    std::string_view query;  ///< after the "?" of the target
  };

  /// May see everything.
  [[nodiscard]] bool allows(const Request& request) const;
  /// May also cause an action: never for a page of another site.
  [[nodiscard]] bool allows_change(const Request& request) const;
  /// The query shows the right token, which then moves from the address into a cookie.
  [[nodiscard]] bool signs_in(const Request& request) const;
  /// Its name contains the port that the browser uses, since cookies ignore ports; otherwise
  /// another dashboard on the host would be signed out.
  [[nodiscard]] std::string cookie(const Request& request) const;

 private:
  [[nodiscard]] bool is_token(std::string_view word) const;

  std::string token_;
};

/// The token of a file: 16 to 256 letters, digits, '-', '_' and '.', in a file that only its owner
/// may read.  @throws ConfigError
std::string read_token(const std::string& file);

}  // namespace stillhand::dashboard
