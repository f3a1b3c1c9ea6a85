// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace stillhand::support {

/// RMS of a part over the RMS of the whole, of the samples that were added.
class RmsShare {
 public:
  void add(double part, double whole) {
    part_ += part * part;
    whole_ += whole * whole;
  }
  [[nodiscard]] double value() const { return std::sqrt(part_ / whole_); }

 private:
  double part_ = 0.0;
  double whole_ = 0.0;
};

}  // namespace stillhand::support
