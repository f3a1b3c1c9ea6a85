// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/sample_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/spoiled_recordings.hpp"

namespace stillhand::measurement::sample_faults_test {

// The tests of one column at their limits, on rows whose numbers follow from their making.
using Rows = std::vector<double>;

Rows made(int count, const std::function<double(int)>& value_at) {
  Rows out;
  for (int i = 0; i < count; ++i) out.push_back(value_at(i));
  return out;
}

// Whole numbers from -100 to 100, each unlike the one before.
Rows noise(int count) {
  spoiled::Dice dice;
  Rows out = made(count, [&](int) { return std::floor(201.0 * dice.next()) - 100.0; });
  for (std::size_t i = 1; i < out.size(); ++i) out[i] += out[i] == out[i - 1] ? 1.0 : 0.0;
  return out;
}

TEST(SampleFaultsTest, RunsLevelsAndDistancesAreThoseOfTheRows) {
  EXPECT_TRUE(beat({{5, 6}, {15, 16}, {35, 36}, {50, 51}, {65, 66}}));
  EXPECT_FALSE(beat({{5, 6}, {15, 16}, {36, 37}, {51, 52}, {66, 67}})) << "more than twice";
  EXPECT_FALSE(beat({{5, 6}, {15, 16}, {25, 26}, {35, 36}})) << "four show no habit";
  EXPECT_EQ(equal_runs({1, 1, 2, 2, 2, 3}).at(1).rows(), 3u);
  EXPECT_EQ(equal_runs({1, 2, 2, 3, 3, 4, 5, 6}).size(), 6u) << "a quarter of the rows";
  EXPECT_TRUE(equal_runs({1, 2, 2, 3, 4, 5, 6, 7}).empty());
  EXPECT_EQ(equal_runs({1, 2, 2, 2, 3, 4, 5, 6, 7, 8, 9, 1}).size(), 10u) << "three rows";
  const Rows stepped{0, 0, 0, 1, 6};
  EXPECT_EQ(usual_step(stepped, equal_runs(stepped)), 5.0) << "of the steps 1 and 5";
  EXPECT_FALSE(has_many_levels(made(200, [](int i) { return i * 7 % 16; })));
  EXPECT_TRUE(has_many_levels(made(200, [](int i) { return i * 7 % 17; })));
  // From the cubic through the four neighbours: a cubic lies on it.
  const Rows impulse = made(9, [](int i) { return i * i * i + (i == 4 ? 6.0 : 0.0); });
  const double off[]{1.0, -4.0, 6.0, -4.0, 1.0};
  for (std::size_t i = 2; i < 7; ++i) EXPECT_EQ(above_neighbours(impulse, i), off[i - 2]);
  // Rows of 4 +1 and -1 are all 1 + 8/6 + 2/6 off; 1.4826 makes a deviation of a median.
  const Rows saw = made(50, [](int i) { return i % 2 == 0 ? 5.0 : 3.0; });
  EXPECT_NEAR(usual_off_neighbours(saw), 1.4826 * 8.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(usual_off_neighbours({0, 0, 6, 0, 0}), 1.4826 * 6.0) << "the middle row alone";
  EXPECT_EQ(deviation_of(saw), 1.0);
}

// ME-12, ME-14, ME-15.
TEST(SampleFaultsTest, CountersOverflowsAndCoarseLevelsAreKnownByTheirShares) {
  const auto modulo = [](int count, int by) { return made(count, [=](int i) { return i % by; }); };
  EXPECT_TRUE(counts_rows(modulo(500, 50))) << "9 of 499 steps go back, below 2 %";
  EXPECT_FALSE(counts_rows(modulo(400, 40))) << "9 of 399";
  EXPECT_FALSE(counts_rows(made(400, [](int i) { return 0.5 * i; })));
  EXPECT_FALSE(counts_rows(Rows(400, 3.0)));
  EXPECT_EQ(overflows(modulo(40, 16)).size(), 2u);
  EXPECT_TRUE(overflows(modulo(24, 16)).empty()) << "one jump";
  EXPECT_TRUE(overflows(modulo(100, 16)).empty()) << "at even intervals: the source's own";
  // Of n even levels the variance is (n^2 - 1)/12 steps^2, a hundredth of it is 1/12 at n = 10.05.
  EXPECT_EQ(coarse_levels(modulo(400, 4)), 4u);
  EXPECT_EQ(coarse_levels(modulo(400, 10)), 10u);
  EXPECT_EQ(coarse_levels(modulo(440, 11)), 0u);
  EXPECT_EQ(coarse_levels(modulo(300, 3)), 0u) << "a switch";
  // Their variances are 7.5, 7.6 and 7.6.
  EXPECT_EQ(coarse_levels({5, 6, 9, 12}), 4u) << "1/12 above 0.075";
  EXPECT_EQ(coarse_levels({5, 5.9, 9, 12}), 0u) << "0.81/12 below 0.076";
  EXPECT_EQ(coarse_levels({5, 8, 11.1, 12}), 0u);
  // Ramps up to 16, and back to where each begins.
  const auto jumps = [](const std::vector<int>& begins, int rest = 1) {
    Rows out;
    for (const int first : begins) {
      for (int at = first; at < 16 + rest; ++at) out.push_back(std::min(at, 16));
    }
    return overflows(out).size();
  };
  EXPECT_EQ(jumps({0, 4, 4}), 2u) << "three quarters of the range";
  EXPECT_EQ(jumps({0, 5, 5}), 0u);
  EXPECT_EQ(jumps({0, 4, 4}, 2), 0u) << "it rests before it jumps";
  EXPECT_EQ(jumps({0, 4, 4, 4, 4, 11}), 4u) << "one other jump on four";
  EXPECT_EQ(jumps({0, 4, 4, 4, 11}), 0u);
}

// ME-11, ME-17, ME-19: values held, and lines between them, of so many rows each.
TEST(SampleFaultsTest, WhatIsHeldOrDrawnIsFoundWithItsRows) {
  const Rows knots = noise(600);
  const auto held = [&](int count, int rows) {
    return made(count, [=, &knots](int i) { return knots.at(i / rows); });
  };
  const auto lines = [&](int count, int rows) {
    return made(count, [=, &knots](int i) {
      const double part = static_cast<double>(i % rows) / rows;
      return (1.0 - part) * knots.at(i / rows) + part * knots.at(i / rows + 1);
    });
  };
  const Rows fours = held(200, 4);
  EXPECT_EQ(held_rows(fours, equal_runs(fours), 8.0), 4.0);
  EXPECT_EQ(held_rows(fours, equal_runs(fours), 7.9), 0.0) << "more than half a second";
  EXPECT_EQ(held_rows(held(196, 4), equal_runs(held(196, 4)), 8.0), 0.0) << "49 runs";
  EXPECT_EQ(straight_rows(lines(251, 5), 10.0), 5.0);
  EXPECT_EQ(straight_rows(lines(251, 5), 9.9), 0.0);
  EXPECT_EQ(straight_rows(lines(246, 5), 10.0), 0.0) << "49 lines";
  // Chords over L rows of the parabola a t^2 are off by a^2 L^4/30 on the mean of the squares.
  const Rows parabola = made(2001, [](int i) {
    const double knot = i / 10 * 10;
    return knot * knot + (2.0 * knot + 10.0) * (i - knot);
  });
  EXPECT_NEAR(chord_error(parabola, 10.0) * std::pow(deviation_of(parabola), 2.0), 333.3, 3.3);
  // A comb is found to a tenth of a bin of 512.
  EXPECT_NEAR(comb_rows(held(514, 12), 1, 100.0), 12.0, 0.0141) << "0.05/512 of 12^2; 8.3 Hz";
  EXPECT_EQ(comb_rows(held(514, 13), 1, 100.0), 0.0) << "7.7 Hz";
  EXPECT_NEAR(comb_rows(held(258, 4), 1, 100.0), 4.0, 0.01);
  EXPECT_EQ(comb_rows(held(257, 4), 1, 100.0), 0.0) << "fewer than 256 steps";
  EXPECT_NEAR(comb_rows(lines(514, 5), 2, 100.0), 5.0, 0.01);
  EXPECT_NEAR(comb_rows(lines(514, 3), 2, 100.0), 3.0, 0.01) << "without a second line";
  for (const int order : {1, 2}) EXPECT_EQ(comb_rows(noise(514), order, 100.0), 0.0);
  for (double per_row = 0.02; per_row < 0.5; per_row += 0.03) {
    const Rows hum = made(514, [=](int i) { return std::sin(6.2832 * per_row * i + 1.0); });
    for (const int order : {1, 2}) EXPECT_EQ(comb_rows(hum, order, 100.0), 0.0) << per_row;
  }
}

// ME-11: 95 % of 60 runs are 57.
TEST(SampleFaultsTest, RunsAreHeldByTheirLengthsAndByWhatTheyCost) {
  // `count` runs of a length, then others; each is `size` up or down from the one before.
  const auto rows_of = [](int runs, int count, int length, int other, double size, int turn = 1) {
    Rows x;
    double at = 0.0;
    for (int k = 0; k < runs; ++k) {
      at += k == 7 ? 1.0 : k / turn % 2 == 0 ? -size : size;
      x.insert(x.end(), static_cast<std::size_t>(k < count ? length : other), at);
    }
    return held_rows(x, equal_runs(x), 100.0);
  };
  EXPECT_EQ(rows_of(50, 25, 3, 1, 3.0), 2.0) << "one row from the mean";
  EXPECT_EQ(rows_of(50, 25, 2, 1, 3.0), 1.5) << "half of the values are repeated";
  EXPECT_EQ(rows_of(50, 24, 2, 1, 3.0), 0.0);
  EXPECT_DOUBLE_EQ(rows_of(60, 57, 4, 1, 3.0), 231.0 / 60.0);
  EXPECT_EQ(rows_of(60, 56, 4, 1, 3.0), 0.0);
  EXPECT_EQ(rows_of(60, 60, 4, 4, 2.9), 0.0) << "below three of the smallest step";
  // N steps of s up and N down have a variance of (N s)^2/12: a hundredth is s^2/3 at N = 20.
  EXPECT_EQ(rows_of(120, 120, 4, 4, 10.0, 15), 4.0);
  EXPECT_EQ(rows_of(120, 120, 4, 4, 10.0, 24), 0.0);
}

// ME-7, on 200 rows from -10 to 10.
TEST(SampleFaultsTest, AValueIsFarBeyondTheRangeOfTheOthersOrNot) {
  const auto found = [](int first, int count, double value) {
    const auto far = [=](int i) { return i >= first && i < first + count; };
    return far_values(made(200, [=](int i) { return far(i) ? value : i % 21 - 10.0; }));
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(found(50, 2, sign * 29.5).at(0).places.at(0).rows(), 2u);
    EXPECT_TRUE(found(50, 2, sign * 29.0).empty()) << "19 off, as -9 is of 10";
    for (const int row : {0, 50, 199}) EXPECT_TRUE(found(row, 1, sign * 99.0).empty()) << "once";
    EXPECT_EQ(found(0, 100, sign * 99.0).at(0).rows(), 100u) << "half of the rows";
    EXPECT_TRUE(found(0, 101, sign * 99.0).empty());
    for (const double end : {63.0, 64.0, 126.0, 127.0, 128.0, 130.0, 999.0, 4095.0, 32768.0}) {
      const bool is_rail = end == 127.0 || end == 128.0 || end > 1000.0;
      EXPECT_EQ(found(0, 9, sign * end).at(0).what, is_rail ? "rail" : "sentinel") << end;
    }
  }
  // Of ten such values the eight farthest count; what is left of another column is a state.
  const auto decades = [](int i) { return i < 20 ? std::pow(10.0, 2 + i / 2) : i % 17; };
  EXPECT_EQ(far_values(made(200, decades)).size(), 8u);
  EXPECT_TRUE(far_values(made(200, [](int i) { return i < 2 ? 99.0 : i % 16; })).empty());
}

// 15 rows of a cubic, which ME-8 predicts; rows that are usually 20 off make a limit of 500 for a
// jump, and of 160, or a tenth of the jump, for the rows at its sides.
TEST(SampleFaultsTest, AJumpGoesOutAndBackWithinTwoRows) {
  // Ten times the row, and the number of rows; 0: none.
  const auto found = [](int rows, double size, int side, double by, double hz = 100.0) {
    const Rows x = made(15, [=](int i) {
      const double jump = i >= 7 && i < 7 + rows ? size : 0.0;
      return 40.0 * std::pow(i - 7, 3) + jump + (i == side ? by : 0.0);
    });
    const auto places = jumps_out_and_back(x, 20.0, hz);
    return places.empty() ? 0 : static_cast<int>(10 * places[0].first + places[0].rows());
  };
  EXPECT_EQ(found(1, 500.0, 0, 0.0, 50.0), 71) << "20 ms";
  EXPECT_EQ(found(1, 499.5, 0, 0.0, 50.0), 0);
  EXPECT_EQ(found(1, 500.0, 0, 0.0, 49.9), 0);
  EXPECT_EQ(found(2, 900.0, 0, 0.0, 99.9), 0);
  EXPECT_EQ(found(3, 900.0, 0, 0.0, 1000.0), 0);
  EXPECT_EQ(found(2, 600.0, 8, 9400.0), 81) << "the second row alone";
  for (const double sign : {1.0, -1.0}) {
    for (const auto& [rows, side] : {std::pair(1, 6), {1, 8}, {2, 6}, {2, 9}}) {
      EXPECT_EQ(found(rows, 900.0, side, sign * 160.0), 70 + rows) << side;
      EXPECT_EQ(found(rows, 900.0, side, sign * 160.5), 0) << side;
      // The line from row 6 to row 9 lies 140 above the cubic's middle.
      const double size = 1860.0 + 140.0 * rows + sign * 100.0;
      EXPECT_EQ(found(rows, size, side, sign * 200.0), 70 + rows) << side;
      EXPECT_EQ(found(rows, size, side, sign * 202.0), 0) << side;
    }
  }
  for (const std::size_t row : {2u, 3u, 10u, 11u}) {
    Rows x(15, 0.0);
    x[row] = 1000.0;
    EXPECT_EQ(jumps_out_and_back(x, 20.0, 100.0).size(), row == 3 || row == 10 ? 1u : 0u) << row;
    EXPECT_TRUE(jumps_out_and_back(x, 0.0, 100.0).empty());
  }
}

// ME-8: 4000 rows of a triangle of -100 to 100 and a saw of +-1.  Without a 400th at either end,
// nine rows that lie out there, they range from -100 to 101.
TEST(SampleFaultsTest, SpikesAreBeyondTheRangeFewAndAlone) {
  const auto found = [](double size, std::size_t count, int quiet) {
    Rows x = made(4000, [](int i) {
      if (i < 9 || i >= 3991) return (i < 9 ? 303.0 : -301.0) - i % 2;
      return 100.0 - std::abs(i % 400 - 200) + (i % 2 == 0 ? 1.0 : -1.0);
    });
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t row = k == 0 ? 3600 : 85 + 15 * k;
      x[row] = 0.5 * (x[row - 1] + x[row + 1]) + size;
    }
    return spikes_in(x, 100.0, [quiet](const Place&) mutable { return quiet-- > 0; });
  };
  EXPECT_FALSE(found(201.0, 188, 188));
  const auto sut = found(202.0, 188, 188);
  ASSERT_TRUE(sut);
  // The rows of 303 and of -302 lie more than a range beyond it, those of 302 and -301 do not.
  EXPECT_EQ(sut->places.size(), 5u + 188u + 5u);
  EXPECT_EQ(sut->rows(), 5u + 188u + 5u);
  EXPECT_TRUE(found(202.0, 188, 142)) << "141 of 188 are three quarters";
  EXPECT_FALSE(found(202.0, 188, 141));
  EXPECT_TRUE(found(202.0, 190, 190)) << "200 of 4000 rows";
  EXPECT_FALSE(found(202.0, 191, 191));
}

// ME-9: a triangle in steps of 1 between 0 and a top, and a rest of it with one step in and out.
TEST(SampleFaultsTest, AChannelIsStuckThatStopsUnlikeItself) {
  struct Rest {
    int rows = 30, first = 106, total = 600, top = 40, digits = 1, level = 0;
    double out = 1.0, slow = 1.0, digit = 0.0, rate_hz = 100.0;
  };
  const auto stuck = [](double in, const Rest& rest) {
    double at = 0.0;
    int moved = 0;
    Rows x = made(rest.total, [&](int i) {
      const int into = i - rest.first;
      if (into > 0 && into < rest.rows) return at + rest.digit * (into % rest.digits);
      const double before = into > -6 && into < 0 ? rest.slow : 1.0;
      const double size = into == 0 ? in : into == rest.rows ? rest.out : before;
      return at += moved++ / rest.top % 2 == 0 ? size : -size;
    });
    for (int k = 0; k < rest.level; ++k) x.at(300 + k) = x.at(106);
    return stuck_in(x, rest.rate_hz, [](const Place&) { return true; }).has_value();
  };
  for (const bool is : {true, false}) {
    for (const double sign : {1.0, -1.0}) EXPECT_EQ(stuck(is ? sign * 4.0 : sign * 3.9, {}), is);
    EXPECT_EQ(stuck(1.0, {.out = is ? 4.0 : 3.9}), is);
    EXPECT_EQ(stuck(4.0, {.rows = is ? 20 : 19}), is);
    EXPECT_EQ(stuck(4.0, {.rows = is ? 10 : 9, .rate_hz = 40.0}), is);
    EXPECT_EQ(stuck(4.0, {.rows = is ? 30 : 29, .level = 3}), is) << "ten of the other's rows";
    EXPECT_EQ(stuck(4.0, {.first = is ? 6 : 5}), is);
    EXPECT_EQ(stuck(4.0, {.slow = is ? 0.25 : 0.1875}), is);
    EXPECT_EQ(stuck(1.0, {.rows = 999, .total = is ? 530 : 531}), is) << "106 rows that move";
    EXPECT_EQ(stuck(1.0, {.rows = is ? 100 : 99}), is) << "a second";
    EXPECT_EQ(stuck(1.0, {.rows = 100, .level = is ? 2 : 3}), is) << "at another rest's value";
    EXPECT_EQ(stuck(1.0, {.total = is ? 136 : 137}), is) << "to the end";
    EXPECT_EQ(stuck(1.0, {.top = is ? 5 : 8}), is) << "deviations of 1.6 and 2.6";
    EXPECT_EQ(stuck(4.0, {.digits = is ? 5 : 6, .digit = 1.0 / 64.0}), is);
  }
  EXPECT_FALSE(stuck(4.0, {.digits = 5, .digit = 1.0 / 32.0}));
}

// ME-10: runs of 10, some behind a 9, over other values.
TEST(SampleFaultsTest, AClippedChannelHasRunsOfManyLengthsAtItsEnd) {
  // @param runs  their rows; below 0: not behind a 9
  const auto clipped = [](const std::vector<int>& runs, double offset = 0.0, double sign = 1.0) {
    Rows x;
    for (const int run : runs) {
      if (!x.empty()) x.insert(x.end(), {5.0 - static_cast<double>(x.size()), 0.5});
      if (run > 0) x.push_back(9.0);
      x.insert(x.end(), static_cast<std::size_t>(std::abs(run)), 10.0);
    }
    if (runs.back() > 0) x.push_back(4.0);
    for (double& value : x) value = sign * (value + offset);
    const auto found = clipped_in(x, equal_runs(x));
    return found ? std::to_string(found->rows()) + " at " + found->detail : "";
  };
  EXPECT_EQ(clipped({-5, 3, 3, 6, -5}), "22 at 10");
  EXPECT_EQ(clipped({-5, 3, 3, 6, -5}, 0.0, -1.0), "22 at -10");
  EXPECT_EQ(clipped({-5, 3, 3, 6, -5}, -10.0), "") << "rests at 0";
  EXPECT_EQ(clipped({-5, 3, 3, 5, -5}), "") << "a trapezoid's";
  EXPECT_EQ(clipped({-3, 5, 5, 7, -3}), "") << "those at the ends may be cut";
  EXPECT_EQ(clipped({-5, 3, 2, 6}), "14 at 10") << "two rows may be chance";
  EXPECT_EQ(clipped({3, 3, 6}), "12 at 10") << "four times as often as the next value";
  EXPECT_EQ(clipped({3, 3, 6, 1, 1, 1}), "");
}

// ME-13: blocks of 17 and of -17 with a saw of +-1, whose bend is 2: 6 deviations are 17.8.
TEST(SampleFaultsTest, DropOutsJumpToZeroAndAreNotInTime) {
  // A zero in an odd row jumps from 18 or -16, one in an even row from 16 or -18.
  const auto found = [](const std::vector<int>& rows, double high = 17.0, double low = -17.0,
                        double rate_hz = 95.0) {
    Rows x = made(400, [=](int i) { return (i / 100 % 2 ? low : high) + (i % 2 ? -1.0 : 1.0); });
    for (const int row : rows) x[static_cast<std::size_t>(row)] = 0.0;
    const auto bad = dropped_in(x, rate_hz);
    return bad ? bad->rows() : 0u;
  };
  std::vector<int> jumps{5, 31, 45, 75};
  EXPECT_EQ(found(jumps), 0u) << "four";
  for (int row = 201; row < 220; ++row) jumps.push_back(row);
  EXPECT_EQ(found(jumps), 4u + 19u) << "19 rows are 0.2 s at 95 Hz";
  EXPECT_EQ(found(jumps, 17.0, -17.0, 94.9), 0u);
  EXPECT_EQ(found(jumps, 16.7, -16.7), 0u) << "from 17.7";
  for (const double one : {17.0, -17.0}) EXPECT_EQ(found(jumps, one, one), 0u) << "of one sign";
  EXPECT_EQ(found({5, 15, 25, 35, 45, 55}), 0u) << "in time";
  jumps.insert(jumps.end(), {0, 12, 22, 52, 62});
  EXPECT_EQ(found(jumps), 23u + 5u) << "half of the zeros jump";
  jumps.push_back(82);
  EXPECT_EQ(found(jumps), 0u);
}

// ME-17.
TEST(SampleFaultsTest, AHeldValueStaysAndStepsOn) {
  const Rows knots = noise(600);
  // That part of each jump goes back before the next.
  for (const double part : {0.45, 0.55}) {
    double at = 0.0, jump = 0.0;
    const Rows x = made(514, [&](int i) {
      if (i % 5 != 0) return at -= part * jump / 4.0;
      jump = knots.at(i / 5) - at;
      return at = knots.at(i / 5);
    });
    EXPECT_NEAR(comb_rows(x, 1, 100.0), part < 0.5 ? 5.0 : 0.0, 0.01);
  }
  // At 40 Hz and more a hand goes on from step to step; values at random turn.
  const Rows pairs = made(514, [&](int i) { return knots.at(i / 2); });
  EXPECT_EQ(comb_rows(pairs, 1, 79.9), 2.0);
  EXPECT_EQ(comb_rows(pairs, 1, 80.0), 0.0);
  EXPECT_EQ(comb_rows(made(514, [](int i) { return std::sin(0.1 * (i / 2 * 2)); }), 1, 100.0), 2.0);
  // Up and down in so many steps, as above.
  for (const int n : {15, 24}) {
    const Rows stairs = made(514, [n](int i) { return std::abs(i / 4 % (2 * n) - n); });
    EXPECT_NEAR(comb_rows(stairs, 1, 100.0), n == 15 ? 4.0 : 0.0, 0.01);
  }
}

// ME-19: jumps at such intervals over a saw of +-0.5, whose steps make a limit of 3.26.
TEST(SampleFaultsTest, UnevenStepsAreManyAloneAndGoOnAndBack) {
  const auto rows_of = [](const std::vector<int>& intervals, const Rows& jumps, double hz = 100.0) {
    std::size_t k = 0;
    int next = intervals[0];
    double at = 0.0;
    const auto value_at = [&](int i) {
      if (i != next) return at += i % 2 == 0 ? 1.0 : -1.0;
      next += intervals[(k + 1) % intervals.size()];
      return at += jumps[k++ % jumps.size()];
    };
    return uneven_rows(made(514, value_at), hz);
  };
  // 102 jumps in 512 steps; the steps of the saw that they replace cancel.
  const std::vector<int> fives{4, 5, 6, 5};
  const double found = 512.0 / 102.0;
  EXPECT_DOUBLE_EQ(rows_of(fives, {3.28, 3.28, -3.28, -3.28}), found);
  EXPECT_EQ(rows_of(fives, {3.25, 3.25, -3.25, -3.25}), 0.0);
  EXPECT_EQ(rows_of(fives, {20, 20, -20, -20}, 40.0), 0.0) << "8 Hz";
  EXPECT_DOUBLE_EQ(rows_of({19}, {20, 20, -20, -20}, 1000.0), 512.0 / 26.0);
  EXPECT_EQ(rows_of({21}, {20, 20, -20, -20}, 1000.0), 0.0) << "below a twentieth";
  EXPECT_EQ(rows_of({1, 9}, {20, 20, -20, -20}), 0.0) << "two next to each other";
  EXPECT_DOUBLE_EQ(rows_of(fives, {20, -20, 20, 20, -20, -20}), found) << "a third goes on";
  EXPECT_EQ(rows_of(fives, {20, -20, 20, -20, 20, 20, -20, 20, -20, -20}), 0.0) << "a fifth";
  EXPECT_DOUBLE_EQ(rows_of(fives, {10, 10, 10, -30}), found) << "a quarter goes back";
  EXPECT_EQ(rows_of(fives, {10, 10, 10, 10, 10, -50}), 0.0) << "a sixth";
  for (const int up : {15, 24}) {  // as above, the cost
    const Rows jumps = made(2 * up, [up](int i) { return i < up ? 10.0 : -10.0; });
    EXPECT_DOUBLE_EQ(rows_of(fives, jumps), up == 15 ? found : 0.0);
  }
}

}  // namespace stillhand::measurement::sample_faults_test
