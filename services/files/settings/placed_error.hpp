// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::settings {

/// A mistake in settings that is found after they were read, and the place of its cause.
class PlacedError : public ConfigError {
 public:
  /// Message: "<where>: <message of the error>".
  PlacedError(const std::string& where, const ConfigError& error)
      : ConfigError(where, "", ""), text_(in_one_line(where) + ": " + error.what()) {}
  [[nodiscard]] const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

/// The result of a call.  @param where  "devices.yaml", "devices.drive.port"
/// @throws PlacedError for a ConfigError of the call
template <typename Call>
auto placed(const std::string& where, Call&& call) {
  try {
    return call();
  } catch (const ConfigError& error) {
    throw PlacedError(where, error);
  }
}

}  // namespace stillhand::settings
