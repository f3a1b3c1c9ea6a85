// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace stillhand {

/// A setting or file the operator can fix.  Thrown only before a run starts; main() prints it as
/// one line and exits with 2.
class ConfigError : public std::runtime_error {
 public:
  /// Message: "<key>: got <got>, want <want>", for example
  /// "motion.components[0].harmonic: got 4000, want 0 < k < 4000 (Nyquist)".
  ConfigError(const std::string& key, const std::string& got, const std::string& want)
      : std::runtime_error(key + ": got " + got + ", want " + want) {}
};

}  // namespace stillhand
