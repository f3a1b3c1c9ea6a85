// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace stillhand::session {

/// Blocks into which a trial is cut for the jackknife.
inline constexpr std::size_t kJackknifeBlocks = 10;

/// The jackknife's variance of a statistic over kJackknifeBlocks blocks (Miller, Biometrika 61,
/// 1974).
/// @param without  the statistic without block j
double jackknife_variance(const std::function<double(std::size_t)>& without);

/// Half width of the 95 % interval of such a variance: t of kJackknifeBlocks - 1 degrees of
/// freedom.
double jackknife_reach(double variance);

}  // namespace stillhand::session
