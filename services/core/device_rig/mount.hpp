// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

namespace stillhand::device_rig {

/// How a three-axis sensor sits on the platform, METHOD Eq. DR-33: a = M s, with the readings s of
/// its channels x, y, z, and a the same vector forward, to the right and up.  The rows of M are
/// these directions in the sensor's own axes.  Pure.
class Mount {
 public:
  /// @param text  nine numbers, row by row, such as "1 0 0, 0 -1 0, 0 0 1"
  /// @throws ConfigError naming `key` unless M keeps lengths and right angles (within 0.001): the
  ///         platform's axes are left-handed, so that M may mirror
  Mount(const std::string& key, const std::string& text);

  /// A reading that is no number makes all three none.
  [[nodiscard]] std::array<double, 3> turned(const std::array<double, 3>& reading) const noexcept;

 private:
  std::array<std::array<double, 3>, 3> rows_{};
};

}  // namespace stillhand::device_rig
