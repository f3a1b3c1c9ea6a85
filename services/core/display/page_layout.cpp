// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/page_layout.hpp"

#include <algorithm>
#include <sstream>

namespace stillhand::display {
namespace {

constexpr double kWhite = 255.0;
constexpr double kQuiet = 150.0;  // dimmer than the task, so that it does not draw the eye
constexpr double kOff = 90.0;     // a button that does not work yet

// Shares of the screen's height.
constexpr double kMargin = 0.035;
constexpr double kCorner = 0.026;
constexpr double kHeading = 0.056;
constexpr double kBody = 0.036;
constexpr double kCaption = 0.030;
constexpr double kLarge = 0.150;
constexpr double kWord = 0.030;
constexpr double kHint = 0.026;
constexpr double kRig = 0.0245;  // the rig's parts, in the lower margin
constexpr double kBox = 0.084;
constexpr double kGap = 0.055;      // between two parts of the column
constexpr double kLeading = 1.35;   // of a line to the next, in ems
constexpr double kParagraph = 0.8;  // between two lines of the prompt, in ems
constexpr double kColumn = 0.86;    // share of the width

// From the top of a line to its baseline, in ems; of DejaVu Sans.
constexpr double kAscent = 0.80;
constexpr double kLineHeight = 1.0;
constexpr double kCapital = 0.73;

/// The column, from its top down.  Places count from 0 and are moved at the end.
class Column {
 public:
  Column(const ScreenConfig& screen, const TextWidth& width, double scale)
      : height_m_(screen.height_m), width_m_(screen.width_m), width_(&width), scale_(scale) {}

  /// One paragraph, broken and centred.
  void write(const std::string& text, double size, double grey, bool bold) {
    if (text.empty()) return;
    gap();
    paragraph(text, size, grey, bold);
  }
  void write(const std::vector<std::string>& lines, double size) {
    if (lines.empty()) return;
    gap();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (i > 0) y_m_ -= kParagraph * em(size);
      paragraph(lines[i], size, kWhite, false);
    }
  }
  void scale(const Page& page) {
    if (page.steps == 0) return;
    gap();
    constexpr double kPitch = 1.35;  // of a box to the next, in sides
    const double most_m = kColumn * width_m_ / static_cast<double>(page.steps);
    const double side_m = std::min(size_m(kBox), most_m / kPitch);
    const double pitch_m = kPitch * side_m;
    const double first_m = -0.5 * pitch_m * static_cast<double>(page.steps - 1);
    for (std::int64_t value = 1; value <= page.steps; ++value) {
      const double x_m = first_m + pitch_m * static_cast<double>(value - 1);
      box({x_m - side_m / 2, x_m + side_m / 2, y_m_ - side_m, y_m_}, value, std::to_string(value),
          kBody, value == page.chosen, kWhite);
    }
    y_m_ -= side_m;
    const double left_m = first_m - side_m / 2;
    words_at_the_ends(page, left_m);
  }
  void button(const Page& page) {
    if (page.button.empty()) return;
    gap();
    const double half_m = (*width_)(page.button, em(kBody), true) / 2 + em(kBody);
    const double high_m = 2.0 * em(kBody);
    box({-half_m, half_m, y_m_ - high_m, y_m_}, kButton, page.button, kBody, page.button_works,
        page.button_works ? kWhite : kOff);
    y_m_ -= high_m;
  }

  [[nodiscard]] double used_m() const { return -y_m_; }
  /// A single word can be wider than the column.
  [[nodiscard]] bool fits(double height_m) const {
    return used_m() <= height_m && widest_m_ <= kColumn * width_m_;
  }
  /// Moves the column so that its top is there.
  PageLayout placed(double top_m) {
    for (PlacedText& text : layout_.texts) text.baseline_m += top_m;
    for (PlacedBox& each : layout_.boxes) {
      each.area.bottom_m += top_m;
      each.area.top_m += top_m;
    }
    return std::move(layout_);
  }

 private:
  [[nodiscard]] double size_m(double share) const { return share * height_m_ * scale_; }
  [[nodiscard]] double em(double share) const { return size_m(share); }
  void gap() {
    if (y_m_ < 0.0) y_m_ -= size_m(kGap);
  }
  void paragraph(const std::string& text, double size, double grey, bool bold) {
    const double em_m = em(size);
    const auto width = [&](const std::string& part) { return (*width_)(part, em_m, bold); };
    bool first = true;
    for (const std::string& line : broken(text, kColumn * width_m_, width)) {
      if (!first) y_m_ -= (kLeading - kLineHeight) * em_m;
      first = false;
      widest_m_ = std::max(widest_m_, width(line));
      layout_.texts.push_back({line, 0.0, 0.5, y_m_ - kAscent * em_m, em_m, grey, bold});
      y_m_ -= kLineHeight * em_m;
    }
  }
  void box(const Bar& area, std::int64_t value, const std::string& text, double size, bool filled,
           double grey) {
    layout_.boxes.push_back({area, value, filled, grey});
    const double em_m = em(size);
    const double baseline_m = (area.bottom_m + area.top_m) / 2 - kCapital / 2 * em_m;
    layout_.texts.push_back(
        {text, (area.left_m + area.right_m) / 2, 0.5, baseline_m, em_m, filled ? 0.0 : grey, true});
  }
  // Left under the first box and right under the last one, each in its half.
  void words_at_the_ends(const Page& page, double left_m) {
    if (page.lowest.empty() && page.highest.empty()) return;
    y_m_ -= 0.5 * em(kWord);
    const double em_m = em(kWord);
    const double edge_m = std::max(-left_m, 0.5 * kColumn * width_m_);
    const auto width = [&](const std::string& part) { return (*width_)(part, em_m, false); };
    double lowest_m = y_m_;
    const auto place = [&](const std::string& text, double side, double x_m) {
      double at_m = y_m_;
      for (const std::string& line : broken(text, 0.9 * edge_m, width)) {
        layout_.texts.push_back({line, x_m, side, at_m - kAscent * em_m, em_m, kWhite, false});
        at_m -= 1.2 * em_m;
      }
      lowest_m = std::min(lowest_m, at_m);
    };
    // A long word grows towards the edge of the screen first.
    const auto anchor = [&](const std::string& text) {
      return std::max(-left_m, std::min(edge_m, width(text)));
    };
    place(page.lowest, 0.0, -anchor(page.lowest));
    place(page.highest, 1.0, anchor(page.highest));
    y_m_ = lowest_m;
  }

  double height_m_, width_m_;
  const TextWidth* width_;
  double scale_;
  double y_m_ = 0.0;
  double widest_m_ = 0.0;
  PageLayout layout_;
};

Column column_of(const Page& page, const ScreenConfig& screen, const TextWidth& width,
                 double scale) {
  Column column(screen, width, scale);
  column.write(page.heading, kHeading, kWhite, true);
  column.write(page.lines, kBody);
  column.scale(page);
  column.button(page);
  column.write(page.caption, kCaption, kQuiet, false);
  column.write(page.large, kLarge, kWhite, true);
  column.write(page.below, kBody, kWhite, false);
  return column;
}

}  // namespace

std::optional<std::int64_t> PageLayout::box_at(double x_m, double y_m) const {
  for (const PlacedBox& box : boxes) {
    if (x_m >= box.area.left_m && x_m < box.area.right_m && y_m >= box.area.bottom_m &&
        y_m < box.area.top_m) {
      return box.value;
    }
  }
  return std::nullopt;
}

std::vector<std::string> broken(const std::string& line, double most_m,
                                const std::function<double(const std::string&)>& width) {
  std::vector<std::string> lines;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    if (!lines.empty() && width(lines.back() + " " + word) <= most_m) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

PageLayout lay_out(const Page& page, const ScreenConfig& screen, const TextWidth& width) {
  constexpr double kShrink = 0.92;
  constexpr double kSmallest = 0.3;
  const double margin_m = kMargin * screen.height_m;
  const double corner_m = kCorner * screen.height_m;
  const double hint_m = kHint * screen.height_m;
  const double top_m = screen.height_m / 2 - 2 * margin_m - corner_m;
  const double foot_m = -screen.height_m / 2 + 2 * margin_m + hint_m;
  // Box and cross are at most 0.1 of a screen high, around the track.
  const double track_m = screen.track_above_bottom_m - screen.height_m / 2 + 0.12 * screen.height_m;
  const double bottom_m = page.task ? std::max(foot_m, track_m) : foot_m;
  double scale = 1.0;
  Column column = column_of(page, screen, width, scale);
  while (!column.fits(top_m - bottom_m) && scale > kSmallest) {
    scale *= kShrink;
    column = column_of(page, screen, width, scale);
  }
  PageLayout layout = column.placed((top_m + bottom_m) / 2 + column.used_m() / 2);
  const double edge_m = screen.width_m / 2 - margin_m;
  const double corner_baseline_m = screen.height_m / 2 - margin_m - kAscent * corner_m;
  const auto add = [&](const std::string& text, double x_m, double share, double baseline_m,
                       double em_m) {
    if (text.empty()) return;
    const double most_m = (share == 0.5 ? kColumn : kColumn / 2) * screen.width_m;
    const double fitting_m = em_m * std::min(1.0, most_m / width(text, em_m, false));
    layout.texts.push_back({text, x_m, share, baseline_m, fitting_m, kQuiet, false});
  };
  add(page.corner_left, -edge_m, 0.0, corner_baseline_m, corner_m);
  add(page.corner_right, edge_m, 1.0, corner_baseline_m, corner_m);
  add(page.hint, 0.0, 0.5, -screen.height_m / 2 + margin_m, hint_m);
  // The margin is 0.035 of the height, of which the hint's descenders take 0.005.
  constexpr double kRigBaseline = 0.008;
  add(page.rig, 0.0, 0.5, (kRigBaseline - 0.5) * screen.height_m, kRig * screen.height_m);
  return layout;
}

}  // namespace stillhand::display
