// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stillhand::dashboard {

/// Decides which requests may see the page.  Without a token: requests that name the host as a
/// loopback address, since otherwise a page of another site could reach this one through a host
/// name of its own ("DNS rebinding").  With a token: requests that show it, or a cookie that was
/// given for it.  A cookie is a random number of this object, so it reveals no token and ends with
/// the process.
class Access {
 public:
  /// @param token  for everything; empty: loopback
  /// @param watch_token  shows everything and changes nothing but by an emergency stop; empty: none
  explicit Access(std::string token, std::string watch_token = "");

  /// The parts of a request that decide; empty if missing.
  struct Request {
    std::string_view host, origin, authorization, cookie;
    std::string_view query;  ///< after the "?" of the target
  };

  /// May see everything.
  [[nodiscard]] bool allows(const Request& request) const;
  /// May also cause an action: not with the watching token, and never for a page of another site.
  [[nodiscard]] bool allows_change(const Request& request) const;
  /// May stop the motor: everybody who may see, since a stop is always safe; never for a page of
  /// another site.
  [[nodiscard]] bool allows_emergency_stop(const Request& request) const;
  /// The request shows the watching token or its cookie.
  [[nodiscard]] bool only_watches(const Request& request) const;
  /// The query shows a right token, for which the browser then gets a cookie.
  [[nodiscard]] bool signs_in(const Request& request) const;
  /// That of the token in the query.  Its name contains the port that the browser uses, since
  /// cookies ignore ports; otherwise another dashboard on the host would be signed out.
  [[nodiscard]] std::string cookie(const Request& request) const;

 private:
  enum class Role : std::uint8_t { kNobody, kWatching, kActing };
  [[nodiscard]] Role role_of_token(std::string_view word) const;
  [[nodiscard]] Role role_of(const Request& request) const;

  std::string token_, watch_token_;
  std::string cookie_, watch_cookie_;  ///< random; empty without the token
};

/// The token of a file: 16 to 256 letters, digits, '-', '_' and '.', in a file that only its owner
/// may read.  @throws ConfigError
std::string read_token(const std::string& option, const std::string& file);

}  // namespace stillhand::dashboard
