// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/view_opencv.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <iostream>
#include <limits>
#include <opencv2/core.hpp>
#include <set>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display::view_opencv_test {

constexpr int kColumns = 1024;
constexpr int kRows = 768;
const TrackingDisplay::Config kConfig;

Page page_with(const std::string& heading, const std::string& time) {
  Page page;
  page.corner_left = "Trial 4 of 12";
  page.corner_right = time;
  page.heading = heading;
  return page;
}

TrackingSample sample(double target_m, double cursor_m) {
  return {target_m, cursor_m, false, kGood};
}

int level(const cv::Mat& image, int row, int column) { return image.at<cv::Vec3b>(row, column)[1]; }

/// Edges of the one line that crosses part of a row, from the shares of its outermost pixels.
struct Edges {
  double left = 0.0;
  double right = 0.0;
};
Edges edges(const cv::Mat& image, int row, double near) {
  int first = static_cast<int>(near) - 8;
  while (level(image, row, first) < 255) ++first;
  int last = first;
  while (level(image, row, last + 1) == 255) ++last;
  return {first - level(image, row, first - 1) / 255.0,
          last + 1 + level(image, row, last + 1) / 255.0};
}

/// A row that crosses the box's sides but neither its corners nor the cross.
int row_above_cross(const Projection& projection) {
  const double track_m = kConfig.screen.track_above_bottom_m - kConfig.screen.height_m / 2.0;
  return static_cast<int>(projection.row_of(track_m + 0.012));
}

// Levels are rounded to 1/510 of a pixel; 1e-9 is for rounding of the projection.
constexpr double kEdge_px = 1.0 / 510.0 + 1e-9;

TEST(TrackingViewTest, TheBoxesSidesLieWhereTheProjectionSays) {
  TrackingView sut(kConfig, kColumns, kRows);
  const Projection& projection = sut.projection();
  for (double target_m = -0.13; target_m < 0.13; target_m += 0.01937) {
    // The cross stays away, so that it puts no light into the row.
    const cv::Mat& image = sut.draw(sample(target_m, target_m > 0.0 ? -0.08 : 0.08), {});
    for (const double side_m : {target_m - 0.015, target_m + 0.015}) {
      const auto seen = edges(image, row_above_cross(projection), projection.column_of(side_m));
      EXPECT_NEAR(seen.left, projection.column_of(side_m - 0.0005), kEdge_px);
      EXPECT_NEAR(seen.right, projection.column_of(side_m + 0.0005), kEdge_px);
    }
  }
}

TEST(TrackingViewTest, TheCrossLiesWhereTheProjectionSays) {
  TrackingView sut(kConfig, kColumns, kRows);
  const Projection& projection = sut.projection();
  const double track_m = kConfig.screen.track_above_bottom_m - kConfig.screen.height_m / 2.0;
  const int row = static_cast<int>(projection.row_of(track_m + 0.005));
  for (double cursor_m = -0.14; cursor_m < 0.14; cursor_m += 0.01733) {
    const cv::Mat& image = sut.draw(sample(cursor_m > 0.0 ? -0.1 : 0.1, cursor_m), {});
    const auto seen = edges(image, row, projection.column_of(cursor_m));
    EXPECT_NEAR(seen.left, projection.column_of(cursor_m - 0.0005), kEdge_px);
    EXPECT_NEAR(seen.right, projection.column_of(cursor_m + 0.0005), kEdge_px);
  }
}

// All light of an isolated box is its area: (31^2 - 29^2) mm^2, less than 1 % for the rounding of
// the levels at its edges.
TEST(TrackingViewTest, TheBoxHasItsAreaInMillimetres) {
  TrackingView sut(kConfig, kColumns, kRows);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const double pixels = cv::sum(sut.draw(sample(0.0123, kNan), {}))[1] / 255.0;
  const double metres = pixels / std::pow(sut.projection().pixels_per_metre(), 2.0);
  EXPECT_NEAR(metres, (31.0 * 31.0 - 29.0 * 29.0) * 1e-6, 0.0042 * 120e-6);
}

TEST(TrackingViewTest, TenMicrometresOfMotionAreSeen) {
  TrackingView sut(kConfig, kColumns, kRows);
  const cv::Mat before = sut.draw(sample(0.0, 0.05), {}).clone();
  // 10 um are 0.034 px: 8.6 of 255 levels at each edge of the box's sides.
  const cv::Mat& after = sut.draw(sample(10e-6, 0.05), {});
  EXPECT_GT(cv::norm(before, after, cv::NORM_INF), 7.0);
  EXPECT_LT(cv::norm(before, after, cv::NORM_INF), 10.0);
}

TEST(TrackingViewTest, OnlyWhiteOnBlackIsUsed) {
  TrackingView sut(kConfig, kColumns, kRows);
  const cv::Mat& image = sut.draw(sample(0.03, 0.02), page_with("Hold", "0:12"));
  int brightest = 0;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const auto pixel = image.at<cv::Vec3b>(y, x);
      ASSERT_EQ(pixel[0], pixel[1]);
      ASSERT_EQ(pixel[1], pixel[2]);
      brightest = std::max<int>(brightest, pixel[0]);
    }
  }
  EXPECT_EQ(brightest, 255);
  EXPECT_EQ(level(image, 5, 5), 0);
}

TEST(TrackingViewTest, WordsNextToTheTaskAreAboveItAndChangeNothingOfIt) {
  TrackingView sut(kConfig, kColumns, kRows);
  const auto s = sample(0.0, 0.0);
  const cv::Rect upper(0, 0, kColumns, kRows / 2);
  const cv::Rect lower(0, 2 * kRows / 3, kColumns, kRows / 3);
  const auto drawn = [&](const Page& page) { return sut.draw(s, page).clone(); };
  const cv::Mat none = drawn({});
  EXPECT_EQ(cv::sum(none(upper))[0], 0.0);
  const cv::Mat first = drawn(page_with("Hold", "0:12"));
  EXPECT_GT(cv::norm(none, first, cv::NORM_L1), 0.0);
  for (const cv::Mat& other :
       {drawn(page_with("Hold", "0:11")), drawn(page_with("Please wait", "0:12")), drawn({})}) {
    EXPECT_GT(cv::norm(first, other, cv::NORM_L1), 0.0);
    EXPECT_EQ(cv::norm(none(lower), other(lower), cv::NORM_L1), 0.0);
  }
}

TEST(TrackingViewTest, APageWithoutTheTaskHidesBoxAndCross) {
  TrackingView sut(kConfig, kColumns, kRows);
  Page page;
  page.task = false;
  EXPECT_EQ(cv::sum(sut.draw(sample(0.0, 0.05), page))[0], 0.0);
}

TEST(TrackingViewTest, TheBoxesOfAScaleAreFoundWhereTheyAreSeen) {
  TrackingView sut(kConfig, kColumns, kRows);
  Page page;
  page.task = false;
  page.steps = 7;
  page.chosen = 3;
  page.button = "OK";
  const cv::Mat image = sut.draw(sample(0.0, 0.0), page);
  std::set<std::int64_t> found;
  int filled = 0;
  for (int row = 4; row < kRows; row += 4) {
    for (int column = 4; column < kColumns; column += 4) {
      const auto box =
          sut.box_at(sut.projection().x_of(column + 0.5), sut.projection().y_of(row + 0.5));
      if (!box) continue;
      found.insert(*box);
      filled += *box == 3 && level(image, row, column) > 200 ? 1 : 0;
    }
  }
  EXPECT_EQ(found, (std::set<std::int64_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_GT(filled, 100);  // of about 250 points: the rest is the number
}

// A frame every 16.7 ms.  Drawing words takes some milliseconds, so they are drawn when they change
// alone, at most about once a second.
TEST(TrackingViewTest, TheSameWordsAreNotDrawnTwice) {
  TrackingView sut(kConfig, kColumns, kRows);
  Page page = page_with("Hold", "0:12");
  page.lines.assign(8, std::string(99, 'm'));
  const cv::Mat first = sut.draw(sample(0.0, 0.0), page).clone();
  const cv::Mat again = sut.draw(sample(0.0, 0.0), page).clone();
  EXPECT_EQ(cv::norm(first, again, cv::NORM_L1), 0.0);
  const auto begin = std::clock();
  constexpr int kFrames = 50;
  for (int i = 0; i < kFrames; ++i) sut.draw(sample(0.001 * i, 0.0), page);
  const double frame_ms =
      1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / kFrames;
  page.corner_right = "0:11";
  const auto middle = std::clock();
  sut.draw(sample(0.0, 0.0), page);
  const double words_ms = 1e3 * static_cast<double>(std::clock() - middle) / CLOCKS_PER_SEC;
  std::cout << "a frame takes " << frame_ms << " ms of processor time, with new words " << words_ms
            << " ms\n";
  EXPECT_LT(frame_ms, words_ms);
}

TEST(TrackingViewTest, WhatIsOffTheScreenOrNotFiniteIsNotDrawn) {
  TrackingView sut(kConfig, 640, 480);
  for (const double x_m : {1e300, -1e300, 5.0, -5.0, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(cv::sum(sut.draw(sample(x_m, x_m), {}))[0], 0.0) << x_m;
  }
  EXPECT_GT(cv::sum(sut.draw(sample(0.16, 5.0), {}))[0], 0.0);  // half a box at the edge
}

TEST(TrackingViewTest, ImpossibleSizesAreRefused) {
  EXPECT_THROW(TrackingView(kConfig, 0, 480), ConfigError);
}

}  // namespace stillhand::display::view_opencv_test
