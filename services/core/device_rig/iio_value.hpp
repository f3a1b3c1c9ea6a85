// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace stillhand::device_rig {

/// Value of a converter's number, METHOD Eq. DR-13: (raw + offset) * scale.  At an end of the
/// converter's range it is no measurement (DR-12): NaN.
inline double iio_value(std::int64_t raw, double offset, double scale, std::int64_t lowest,
                        std::int64_t highest) noexcept {
  if (raw <= lowest || raw >= highest) return std::numeric_limits<double>::quiet_NaN();
  return (static_cast<double>(raw) + offset) * scale;
}

}  // namespace stillhand::device_rig
