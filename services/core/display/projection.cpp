// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/projection.hpp"

#include <algorithm>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display {
namespace {

// Below this no line can be distinguished from another; above, an image no longer fits memory.
constexpr int kFewest_px = 16;
constexpr int kMost_px = 16384;

void check(const char* key, int pixels) {
  if (pixels < kFewest_px || pixels > kMost_px) {
    throw ConfigError(key, std::to_string(pixels),
                      std::to_string(kFewest_px) + " to " + std::to_string(kMost_px) + " px");
  }
}

}  // namespace

Projection::Projection(const ScreenConfig& screen, int columns, int rows)
    : centre_column_(columns / 2.0),
      centre_row_(rows / 2.0),
      scale_(std::min(columns / screen.width_m, rows / screen.height_m)) {
  validate(screen, "display.screen");
  check("display.view.columns", columns);
  check("display.view.rows", rows);
}

}  // namespace stillhand::display
