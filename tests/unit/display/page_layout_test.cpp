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

// On a screen of 1.6 m by 1 m, in m and grey.  Of sizes that METHOD gives as shares of the height,
// a baseline is 0.8 em under the top of its line, 0.365 em under the middle of a box; gaps of 0.055
// are between the parts, which are 0.7048 high and stand in the middle.
TEST(PageLayoutTest, EachPartHasItsPlaceSizeAndGrey) {
  ScreenConfig screen;
  screen.width_m = 1.6;
  screen.height_m = 1.0;
  Page page;
  page.task = false;
  page.corner_left = "left";
  page.corner_right = std::string(40, 'r');
  page.heading = "heading";
  page.lines = {"one", "two"};
  page.caption = "caption";
  page.below = "below";
  page.lowest = "low";
  page.highest = "higher";
  page.steps = page.chosen = 2;
  page.button = "OK";
  page.button_works = false;
  page.hint = std::string(80, 'h');
  page.rig = "rig";
  const std::vector<std::vector<double>> expected{
      // x, share of the text left of it, baseline, em, grey, bold
      {0.0, 0.5, 0.3076, 0.056, 255.0, 1.0},                // heading
      {0.0, 0.5, 0.2126, 0.036, 255.0, 0.0},                // one
      {0.0, 0.5, 0.1478, 0.036, 255.0, 0.0},                // two, 0.8 em below it
      {-0.0567, 0.5, 0.03046, 0.036, 255.0, 1.0},           // 1
      {0.0567, 0.5, 0.03046, 0.036, 0.0, 1.0},              // 2, black in its box
      {-0.0987, 0.0, -0.0374, 0.03, 255.0, 0.0},            // low: from the first box's left side
      {0.1872, 1.0, -0.0374, 0.03, 255.0, 0.0},             // higher: as far as it is long
      {0.0, 0.5, -0.15354, 0.036, 90.0, 1.0},               // OK
      {0.0, 0.5, -0.2554, 0.03, 150.0, 0.0},                // caption
      {0.0, 0.5, -0.3452, 0.036, 255.0, 0.0},               // below
      {-0.765, 0.0, 0.4442, 0.026, 150.0, 0.0},             // left corner
      {0.765, 1.0, 0.4442, 0.43 * 1.6 / 41.6, 150.0, 0.0},  // right, not beyond 0.43 of the width
      {0.0, 0.5, -0.465, 0.86 * 1.6 / 83.2, 150.0, 0.0},    // hint, not beyond 0.86 of it
      {0.0, 0.5, -0.492, 0.0245, 150.0, 0.0}};              // rig
  const PageLayout sut = lay_out(page, screen, wide);
  const auto near = [](const std::vector<double>& numbers) {
    return testing::Pointwise(testing::DoubleNear(1e-9), numbers);
  };
  ASSERT_EQ(sut.texts.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const PlacedText& each = sut.texts[i];
    EXPECT_THAT((std::vector{each.x_m, each.share, each.baseline_m, each.em_m, each.grey,
                             each.bold ? 1.0 : 0.0}),
                near(expected[i]))
        << each.text;
  }
  std::vector<double> sides;
  for (const auto& [area, value, filled, grey] : sut.boxes) {
    sides.insert(sides.end(), {area.left_m, area.right_m, area.bottom_m, area.top_m, grey});
  }
  EXPECT_THAT(sides, near({-0.0987, -0.0147, 0.0016, 0.0856, 255.0, 0.0147, 0.0987, 0.0016, 0.0856,
                           255.0, -0.07344, 0.07344, -0.1764, -0.1044, 90.0}));
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
    const auto& [left_m, right_m, bottom_m, top_m] = box.area;
    EXPECT_EQ(sut.box_at(left_m, bottom_m), box.value);
    EXPECT_NE(sut.box_at(right_m, bottom_m), box.value);
    EXPECT_NE(sut.box_at(left_m, top_m), box.value);
  }
  EXPECT_NEAR(sut.boxes[0].area.left_m, -sut.boxes[8].area.right_m, 1e-12);
  EXPECT_THAT(values, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, kButton));
  EXPECT_FALSE(sut.box_at(0.0, 0.11));
}

TEST(PageLayoutTest, ReadableTypeAtTheDistanceOfAMonitor) {
  Page page = fullest(7);
  page.lines = {"How hard was it to keep the cross in the box?"};
  for (const PlacedText& text : lay_out(page, {}, wide).texts) {
    // Capitals of 4 mm at 0.7 m are 20 minutes of arc (ISO 9241-303 recommends 20 to 22, at least
    // 16).
    EXPECT_GE(0.73 * text.em_m, 0.0040) << text.text;
  }
}

TEST(PageLayoutTest, LinesBreakBetweenWords) {
  const auto width = [](const std::string& text) { return static_cast<double>(text.size()); };
  EXPECT_THAT(broken("one two three", 7.0, width), testing::ElementsAre("one two", "three"));
  EXPECT_THAT(broken("extraordinary", 8.0, width), testing::ElementsAre("extraordinary"));
  EXPECT_TRUE(broken("", 8.0, width).empty());
}

}  // namespace stillhand::display::page_layout_test
