// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/session/results.hpp"

namespace stillhand::lab {

inline constexpr const char* kSessionFigure = "session";  ///< .png, .svg, .csv in the folder

/// Draws what cancellation does: in each moving trial the feedthrough force next to the motor's,
/// and the target next to the cursor.  Draws nothing when no trial moved.
/// @return the drawings, for session.html
/// @param folder  there; the figure appears whole or not at all
/// @throws ConfigError without gnuplot; std::runtime_error when a file cannot be written
std::vector<report::Drawing> draw_session(const session::SessionResult& result,
                                          const std::filesystem::path& folder);

}  // namespace stillhand::lab
