// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/view_opencv.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace stillhand::display {
namespace {

constexpr double kWhite = 255.0;
constexpr double kFrame_m = 0.0006;  // of a box

/// Share of pixel [i, i + 1) that lies in [from, to).
double covered(int i, double from, double to) {
  return std::clamp(std::min(to, i + 1.0) - std::max(from, static_cast<double>(i)), 0.0, 1.0);
}

}  // namespace

TrackingView::TrackingView(const TrackingDisplay::Config& config, int columns, int rows)
    : screen_(config.screen),
      layout_(config.screen, config.box_width_m),
      projection_(config.screen, columns, rows),
      words_(rows, columns, CV_8UC3, cv::Scalar::all(0)),
      image_(rows, columns, CV_8UC3, cv::Scalar::all(0)) {}

const cv::Mat& TrackingView::draw(const TrackingSample& sample, const Page& page) {
  if (!page_ || *page_ != page) draw_words(page);
  words_.copyTo(image_);
  if (!page.task) return image_;
  if (std::isfinite(sample.target_m)) {
    for (const Bar& bar : layout_.box(sample.target_m)) paint(bar);
  }
  if (std::isfinite(sample.cursor_m)) {
    for (const Bar& bar : layout_.cross(sample.cursor_m)) paint(bar);
  }
  return image_;
}

void TrackingView::draw_words(const Page& page) {
  page_layout_ = lay_out(page, screen_, [this](const std::string& text, double em_m, bool bold) {
    const double scale = projection_.pixels_per_metre();
    return typeface_.width(text, em_m * scale, bold) / scale;
  });
  words_.setTo(cv::Scalar::all(0));
  for (const PlacedBox& box : page_layout_.boxes) paint(box);
  for (const PlacedText& text : page_layout_.texts) write(text);
  page_ = page;
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

void TrackingView::paint(const PlacedBox& box) {
  constexpr int kFractions = 8;  // OpenCV's fixed point: 1/256 px
  const auto at = [&](double x_m, double y_m) {
    constexpr double kScale = 1 << kFractions;
    return cv::Point(static_cast<int>(std::lround((projection_.column_of(x_m) - 0.5) * kScale)),
                     static_cast<int>(std::lround((projection_.row_of(y_m) - 0.5) * kScale)));
  };
  const int frame_px =
      std::max(1, static_cast<int>(std::lround(kFrame_m * projection_.pixels_per_metre())));
  cv::rectangle(words_, at(box.area.left_m, box.area.top_m),
                at(box.area.right_m, box.area.bottom_m), cv::Scalar::all(box.grey),
                box.filled ? cv::FILLED : frame_px, cv::LINE_AA, kFractions);
}

void TrackingView::write(const PlacedText& text) {
  const double em_px = text.em_m * projection_.pixels_per_metre();
  const double length_px = typeface_.width(text.text, em_px, text.bold);
  typeface_.write(words_, text.text, projection_.column_of(text.x_m) - text.share * length_px,
                  projection_.row_of(text.baseline_m), em_px, text.bold, text.grey);
}

}  // namespace stillhand::display
