// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tests/planted/draw.hpp"
#include "tests/planted/filters.hpp"

namespace stillhand::planted {

enum class NoiseShape { kWhite, kLowPass, kPink, kHeavyTailed, kUneven };

inline constexpr std::array<std::string_view, 5> kNoiseNames{"white", "low_pass", "pink",
                                                             "heavy_tailed", "uneven"};

struct Noise {
  Series values;      ///< with exactly the requested root mean square
  std::string about;  ///< for example "first-order low-pass, corner 0.8 Hz"
};

Noise draw_noise(NoiseShape shape, std::size_t count, double rate_hz, double rms, Draw& draw);

/// Missing rows of a recording.
struct Losses {
  std::vector<bool> lost;
  std::string about;
};

/// @param gaps  2 to 5 gaps of 0.2 to 3 s;  @param single_rows  0.2 to 1 % of the rows, one by one
Losses draw_losses(bool gaps, bool single_rows, std::size_t count, double rate_hz, Draw& draw);

}  // namespace stillhand::planted
