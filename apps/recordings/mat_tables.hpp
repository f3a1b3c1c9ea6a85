// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/recordings/topic_table.hpp"

namespace stillhand::recordings {

/// One MATLAB file (version 5, which MATLAB, Octave and SciPy read), a struct a topic; README,
/// "MATLAB".  Held in memory until publish(): the format wants each variable whole.
std::unique_ptr<TableFile> mat_tables(const std::string& path);

}  // namespace stillhand::recordings
