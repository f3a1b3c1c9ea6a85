// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

namespace stillhand::recording {

/// Check of a numeric option: `least` to `most`, both included.  It refuses NaN, which CLI::Range
/// accepts.
inline CLI::Validator within(double least, double most) {
  std::ostringstream range;
  range << least << " to " << most;
  const std::string want = range.str();
  return {[least, most, want](std::string& word) {
            double value = 0;
            const bool inside =
                CLI::detail::lexical_cast(word, value) && value >= least && value <= most;
            return inside ? std::string() : "got " + word + ", want " + want;
          },
          want};
}

}  // namespace stillhand::recording
