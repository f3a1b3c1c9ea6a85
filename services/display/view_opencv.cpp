// SPDX-License-Identifier: Apache-2.0
#include "services/display/view_opencv.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace stillhand::display {
namespace {

constexpr double kWhite = 255.0;
constexpr double kMargin_m = 0.008;

/// Share of pixel [i, i + 1) that lies in [from, to).
double covered(int i, double from, double to) {
  return std::clamp(std::min(to, i + 1.0) - std::max(from, static_cast<double>(i)), 0.0, 1.0);
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(std::clamp(seconds, 0.0, 359999.0)));
  char text[32];
  std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  return text;
}

const char* notice_text(Notice notice) {
  switch (notice) {
    case Notice::kHold:
      return "HOLD";
    case Notice::kLinkLost:
      return "LINK LOST";
    case Notice::kNone:
      break;
  }
  return "";
}

}  // namespace

TrackingView::TrackingView(const TrackingDisplay::Config& config, int columns, int rows)
    : screen_(config.screen),
      layout_(config.screen, config.box_width_m),
      projection_(config.screen, columns, rows),
      image_(rows, columns, CV_8UC3, cv::Scalar::all(0)) {}

const cv::Mat& TrackingView::draw(const TrackingSample& sample, const ViewStatus& status) {
  image_.setTo(cv::Scalar::all(0));
  write_status(status);
  if (std::isfinite(sample.target_m)) {
    for (const Bar& bar : layout_.box(sample.target_m)) paint(bar);
  }
  if (std::isfinite(sample.cursor_m)) {
    for (const Bar& bar : layout_.cross(sample.cursor_m)) paint(bar);
  }
  return image_;
}

void TrackingView::paint(const Bar& bar) {
  // In doubles until inside the image: a cursor far off the glass must not overflow an int.
  const auto column = [&](double x_m) {
    return std::clamp(projection_.column_of(x_m), 0.0, static_cast<double>(image_.cols));
  };
  const auto row = [&](double y_m) {
    return std::clamp(projection_.row_of(y_m), 0.0, static_cast<double>(image_.rows));
  };
  const double left = column(bar.left_m);
  const double right = column(bar.right_m);
  const double upper = row(bar.top_m);
  const double lower = row(bar.bottom_m);
  for (int y = static_cast<int>(upper); y < lower; ++y) {
    for (int x = static_cast<int>(left); x < right; ++x) {
      const double share = covered(x, left, right) * covered(y, upper, lower);
      const auto level = static_cast<unsigned char>(std::lround(kWhite * share));
      auto& pixel = image_.at<cv::Vec3b>(y, x);
      // Bars cross: the brighter one is what both together look like.
      for (int channel = 0; channel < 3; ++channel) {
        pixel[channel] = std::max(pixel[channel], level);
      }
    }
  }
}

void TrackingView::write(const std::string& text, double x_m, double share, double baseline_y_m,
                         const TextStyle& style) {
  const double height_px = style.height_m * projection_.pixels_per_metre();
  const int stroke_px = std::max(1, static_cast<int>(height_px / 12.0));
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  const double scale =
      cv::getFontScaleFromHeight(kFont, std::max(1, static_cast<int>(height_px)), stroke_px);
  int below_px = 0;
  const cv::Size size = cv::getTextSize(text, kFont, scale, stroke_px, &below_px);
  const double left = projection_.column_of(x_m) - share * size.width;
  const double baseline = projection_.row_of(baseline_y_m);
  cv::putText(image_, text,
              {static_cast<int>(std::lround(left)), static_cast<int>(std::lround(baseline))}, kFont,
              scale, cv::Scalar::all(style.grey), stroke_px, cv::LINE_AA);
}

void TrackingView::write_status(const ViewStatus& status) {
  // Dimmer than the task, so that it does not draw the eye.
  constexpr TextStyle kQuiet{.height_m = 0.0040, .grey = 120.0};
  constexpr TextStyle kLoud{.height_m = 0.0080, .grey = 220.0};
  if (status.trial_number >= 0) {
    const double edge_m = screen_.width_m / 2.0 - kMargin_m;
    const double line_y_m = screen_.height_m / 2.0 - kMargin_m - kQuiet.height_m;
    write("TRIAL " + std::to_string(status.trial_number + 1), -edge_m, 0.0, line_y_m, kQuiet);
    write(clock_text(status.time_left_s), edge_m, 1.0, line_y_m, kQuiet);
  }
  if (status.notice != Notice::kNone) {
    write(notice_text(status.notice), 0.0, 0.5, screen_.height_m * 0.15, kLoud);
  }
}

}  // namespace stillhand::display
