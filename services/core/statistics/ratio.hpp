// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace stillhand::statistics {

/// Two-sided interval of a ratio of means.
struct RatioInterval {
  double ratio = 0.0;  ///< [-] mean(x) / mean(y)
  double low = 0.0;
  double high = 0.0;
};

/// Fieller's interval of mean(x) / mean(y) of paired values, README Eq. ST-16.  None where mean(y)
/// does not differ from 0 at that confidence: the interval is then not bounded.
/// Source: Fieller, J. R. Stat. Soc. B 16(2), 1954.  Pure.
/// @param x, y        equally long, two pairs or more, same unit
/// @param confidence  [-] between 0 and 1
/// @throws stillhand::ConfigError as mean(); when the lengths differ
std::optional<RatioInterval> ratio_interval(const std::vector<double>& x,
                                            const std::vector<double>& y, double confidence = 0.95);

/// How much of a loss a remedy gives back.
struct RestoredShare {
  std::optional<double> share;            ///< [-] none without a person, or without a loss
  std::optional<RatioInterval> interval;  ///< 95 %; none for one person, or where a loss may be 0
};

/// Share of the mean loss from `before` to `after` that `mended` gives back, README Eq. ST-21: 0 is
/// none, 1 is all.  Over the people of whom all three are finite.  Pure.
/// @param before, after, mended  one value a person, same unit; the shortest length counts
RestoredShare restored_share(const std::vector<double>& before, const std::vector<double>& after,
                             const std::vector<double>& mended);

}  // namespace stillhand::statistics
