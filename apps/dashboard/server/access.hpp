// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace stillhand::dashboard {

/// Who may see the page.  On loopback everybody on this host; a request must then name the host as
/// a loopback address, or a page of the world could reach this one by a name of its own ("DNS
/// rebinding").  Elsewhere whoever shows the token.
class Access {
 public:
  /// @param token  empty: loopback
  explicit Access(std::string token) : token_(std::move(token)) {}

  /// What is to be looked at of a request; empty where it has none.
  struct Request {
    std::string_view host, origin, authorization, cookie;
    std::string_view query;  ///< behind the "?" of the target
  };

  /// May see everything.
  [[nodiscard]] bool allows(const Request& request) const;
  /// May also change something: not when another site's page asks.
  [[nodiscard]] bool allows_change(const Request& request) const;
  /// The query shows the right token: it goes into a cookie, and out of the address.
  [[nodiscard]] bool signs_in(const Request& request) const;
  /// Named by the port that the browser asked, since cookies are of a host and know no ports:
  /// another dashboard there is not signed out.
  [[nodiscard]] std::string cookie(const Request& request) const;

 private:
  [[nodiscard]] bool is_token(std::string_view word) const;

  std::string token_;
};

/// The token of a file: 16 to 256 letters, digits, '-', '_' and '.', in a file that only its owner
/// may read.  @throws ConfigError
std::string read_token(const std::string& file);

}  // namespace stillhand::dashboard
