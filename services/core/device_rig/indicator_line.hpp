// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace stillhand::device_rig {

/// Force of a line of a load cell indicator, METHOD Eq. DR-36: `N,+0012.345,g,ST`, without its end.
/// The format is our own; it stands for those of common bench indicators.  Pure.
/// @returns [N], as the indicator's sign says; NaN for an overload (`OL`); nothing for a line that
///          is not whole, of another form, or of another unit than g, kg, N, lb
std::optional<double> indicator_force_n(std::string_view line) noexcept;

}  // namespace stillhand::device_rig
