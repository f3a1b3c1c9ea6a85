// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace stillhand::report {

/// Samples of a signal that a figure can show so that its cycles are seen: ten seconds, or forty
/// cycles of its mean frequency where ten seconds hold fewer than four or more than a hundred.
/// @return at least 2, at most all where there are two
std::size_t excerpt_length(const std::vector<double>& values, double rate_hz);

}  // namespace stillhand::report
