// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>

#include "services/core/diagnosis/record/digits.hpp"

namespace stillhand::diagnosis {

/// A share of a power as "97.6 %".  @param share  [-]; below -1 an error is larger than twice the
/// signal, and its number says nothing.
inline std::string share_in_words(double share) {
  return share < -1.0 ? "nothing (worse than the mean)" : digits(100.0 * share, 3) + " %";
}

/// "VAF 97.62 %".
inline std::string vaf_in_words(double percent) {
  if (percent < -100.0) return "VAF below -100 % (worse than the mean)";
  return fmt::format("VAF {:.2f} %", percent);
}

}  // namespace stillhand::diagnosis
