// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "services/core/display/page.hpp"
#include "services/core/display/screen_layout.hpp"

namespace stillhand::display {

/// A line of text on the screen.
struct PlacedText {
  std::string text;
  double x_m;         ///< of the anchor, right of the screen's centre
  double share;       ///< of the text's length that lies left of x: 0 starts there, 1 ends there
  double baseline_m;  ///< up from the screen's centre
  double em_m;        ///< size of the type
  double grey;        ///< 0 black to 255 white
  bool bold;
};

/// A box that can be clicked.
struct PlacedBox {
  Bar area;
  std::int64_t value;  ///< 1 to the steps of the scale; kButton: the button
  bool filled;
  double grey;  ///< of its frame, and of its ground where it is filled
};

/// Value of the button's box.
inline constexpr std::int64_t kButton = 0;

struct PageLayout {
  std::vector<PlacedText> texts;
  std::vector<PlacedBox> boxes;

  /// Value of the box at a place; nothing: none is there.
  [[nodiscard]] std::optional<std::int64_t> box_at(double x_m, double y_m) const;
};

/// Length of a text on the screen [m].
using TextWidth = std::function<double(const std::string& text, double em_m, bool bold)>;

/// Where the words of a page lie, Eq. DI-9: one column in the middle of the screen, at most 0.86 of
/// its width, lines broken between words; above the box where the task is drawn.  All sizes are
/// shares of the screen's height.  Where the column is too high, every size shrinks until it fits.
/// Pure.
PageLayout lay_out(const Page& page, const ScreenConfig& screen, const TextWidth& width);

/// A line broken between words into lines of at most `most_m`; a longer word is a line of its own.
std::vector<std::string> broken(const std::string& line, double most_m,
                                const std::function<double(const std::string&)>& width);

}  // namespace stillhand::display
