// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/page_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace stillhand::display::page_layout_test {

// A type whose letters are all as wide as the widest of DejaVu Sans Bold's lower case (m: 1.04 em).
double wide(const std::string& text, double em_m, bool /*bold*/) {
  return 1.04 * em_m * static_cast<double>(text.size());
}

struct Extent {
  double left_m, right_m, bottom_m, top_m;
};

Extent extent(const PlacedText& text) {
  const double length_m = wide(text.text, text.em_m, text.bold);
  const double left_m = text.x_m - text.share * length_m;
  // The letters of DejaVu Sans reach from 0.24 em below the baseline to 0.76 em above.
  return {left_m, left_m + length_m, text.baseline_m - 0.24 * text.em_m,
          text.baseline_m + 0.76 * text.em_m};
}

bool overlap(const Extent& a, const Extent& b) {
  constexpr double kRounding_m = 1e-9;
  return a.left_m < b.right_m - kRounding_m && b.left_m < a.right_m - kRounding_m &&
         a.bottom_m < b.top_m - kRounding_m && b.bottom_m < a.top_m - kRounding_m;
}

Page fullest(std::int64_t steps) {
  Page page;
  page.task = false;
  page.corner_left = "Trial 20 of 20";
  page.corner_right = "99:59";
  page.heading = "What you will do";
  page.lines.assign(
      8,
      "seven letters and spaces in a line of the greatest length that the file of the "
      "experiment takes ...");
  page.steps = steps;
  page.lowest = "not at all, and nothing of it ever again";
  page.highest = "more than of anything else in the world.";
  page.button = "OK";
  page.hint = "Press a number, or click on it";
  return page;
}

std::vector<Page> pages() {
  std::vector<Page> all;
  for (const std::int64_t steps : {0, 2, 7, 9}) {
    all.push_back(fullest(steps));
    Page short_one = fullest(steps);
    short_one.lines = {"How hard was it?"};
    all.push_back(short_one);
  }
  Page countdown;
  countdown.corner_left = "Trial 4 of 12";
  countdown.corner_right = "2:51";
  countdown.heading = "Trial 4 of 12";
  countdown.caption = "begins in";
  countdown.large = "59:59";
  all.push_back(countdown);
  Page resting = countdown;
  resting.task = false;
  resting.below = "Next: trial 4 of 12";
  all.push_back(resting);
  for (Page& page : all) {
    page.rig = "rig of devices: force drive, angle drive, motor off; simulated: acceleration";
  }
  return all;
}

// Of the paper's monitor, one that is wide, one that stands upright, and a small one.
std::vector<ScreenConfig> screens() {
  std::vector<ScreenConfig> all(4);
  all[1].width_m = 0.53;
  all[1].height_m = 0.30;
  all[2].width_m = 0.25;
  all[2].height_m = 0.40;
  all[3].width_m = 0.12;
  all[3].height_m = 0.10;
  return all;
}

TEST(PageLayoutTest, EverythingIsOnTheScreenAndNothingOverlaps) {
  for (const ScreenConfig& screen : screens()) {
    for (const Page& page : pages()) {
      const PageLayout sut = lay_out(page, screen, wide);
      std::vector<Extent> all;
      for (const PlacedText& text : sut.texts) {
        const Extent own = extent(text);
        EXPECT_GE(own.left_m, -screen.width_m / 2) << text.text;
        EXPECT_LE(own.right_m, screen.width_m / 2) << text.text;
        EXPECT_GE(own.bottom_m, -screen.height_m / 2) << text.text;
        EXPECT_LE(own.top_m, screen.height_m / 2) << text.text;
        for (const Extent& other : all) EXPECT_FALSE(overlap(own, other)) << text.text;
        all.push_back(own);
      }
      for (std::size_t i = 0; i < sut.boxes.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
          EXPECT_LE(sut.boxes[k].area.right_m,
                    sut.boxes[i].area.left_m + 1e-9 + (sut.boxes[i].value == kButton ? 1.0 : 0.0));
        }
      }
    }
  }
}

TEST(PageLayoutTest, WordsStayAboveTheTask) {
  Page page;
  page.heading = "Trial 4 of 12";
  page.caption = "begins in";
  page.large = "3";
  const ScreenConfig screen;
  const double box_top_m = screen.track_above_bottom_m - screen.height_m / 2 + 0.0155;
  for (const PlacedText& text : lay_out(page, screen, wide).texts) {
    EXPECT_GT(extent(text).bottom_m, box_top_m) << text.text;
  }
}

TEST(PageLayoutTest, AScaleCanBeClickedBoxByBox) {
  const PageLayout sut = lay_out(fullest(9), {}, wide);
  std::vector<std::int64_t> values;
  for (const PlacedBox& box : sut.boxes) {
    values.push_back(box.value);
    EXPECT_EQ(sut.box_at((box.area.left_m + box.area.right_m) / 2,
                         (box.area.bottom_m + box.area.top_m) / 2),
              box.value);
  }
  EXPECT_NEAR(sut.boxes[0].area.left_m, -sut.boxes[8].area.right_m, 1e-12);
  // A number stands in the middle of its box, a square.
  for (const PlacedBox& box : sut.boxes) {
    if (box.value == kButton) continue;
    EXPECT_NEAR(box.area.right_m - box.area.left_m, box.area.top_m - box.area.bottom_m, 1e-12);
    const auto number = std::ranges::find(sut.texts, std::to_string(box.value), &PlacedText::text);
    ASSERT_NE(number, sut.texts.end()) << box.value;
    const Extent own = extent(*number);
    EXPECT_NEAR(own.left_m + own.right_m, box.area.left_m + box.area.right_m, 1e-9);
    EXPECT_GT(number->baseline_m, box.area.bottom_m);
    EXPECT_LT(number->baseline_m, (box.area.bottom_m + box.area.top_m) / 2);
  }
  EXPECT_THAT(values, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, kButton));
  EXPECT_FALSE(sut.box_at(0.0, 0.11));
}

TEST(PageLayoutTest, ReadableTypeAtTheDistanceOfAMonitor) {
  Page page = fullest(7);
  page.lines = {"How hard was it to keep the cross in the box?"};
  int lines = 0;
  for (const PlacedText& text : lay_out(page, {}, wide).texts) {
    // Capitals of 4 mm at 0.7 m are 20 minutes of arc (ISO 9241-303 recommends 20 to 22, at least
    // 16).
    EXPECT_GE(0.73 * text.em_m, 0.0040) << text.text;
    if (!page.lines[0].starts_with(text.text)) continue;
    ++lines;
    EXPECT_NEAR(0.73 * text.em_m, 0.0060, 0.0001);  // Eq. DI-9
  }
  EXPECT_GT(lines, 0);
}

TEST(PageLayoutTest, LinesBreakBetweenWords) {
  const auto width = [](const std::string& text) { return static_cast<double>(text.size()); };
  EXPECT_THAT(broken("one two three", 7.0, width), testing::ElementsAre("one two", "three"));
  EXPECT_THAT(broken("extraordinary", 8.0, width), testing::ElementsAre("extraordinary"));
  EXPECT_TRUE(broken("", 8.0, width).empty());
}

}  // namespace stillhand::display::page_layout_test
