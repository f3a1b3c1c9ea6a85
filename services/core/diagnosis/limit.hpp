// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace stillhand::diagnosis {

/// Levels at which a signal stops following a prediction p of it:
///
///   y = clip(gain p + level, low, high)
///
/// Of an input of Gauss' distribution a limit lets through a smaller gain, and else the body's
/// response (Bussgang, 1952), so that the prediction has the shape of the signal without a limit.
struct Limit {
  double low = 0.0, high = 0.0;  ///< [unit of y]
  double share = 0.0;            ///< [-] of the rows beyond
  double error_ratio = 1.0;      ///< [-] squared error over that of y = gain p + level
};

/// Pure.  Of up to 5000 rows, evenly spread.  @param y, p  one length, at least 40
Limit limit_of(const std::vector<double>& y, const std::vector<double>& p);

/// METHOD Eq. DG-87: the output shows that the input went on where its sensor stays at a limit,
/// also with noise on top; empty: it does not.  Pure.
/// @param x, y  of input and output, without a gap
std::string limit_in_words(const std::string& input, const std::vector<double>& x,
                           const std::string& output, const std::vector<double>& y, double rate_hz);

}  // namespace stillhand::diagnosis
