// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/planted/recording.hpp"

namespace stillhand::planted {

/// Header `t [s],a_y [m/s^2],...,f [N]`, then one row a sample, nine significant digits.
/// @throws std::runtime_error when the file can't be written.
void write_csv(const std::filesystem::path& file, const Recording& recording);
/// The sealed label as JSON.
void write_truth(const std::filesystem::path& file, const Truth& truth);

}  // namespace stillhand::planted
