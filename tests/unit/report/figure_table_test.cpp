// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/figure_table.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stillhand::report::figure_table_test {

constexpr const char* kHead = "panel,x_axis,y_axis,series,x,x_label,y,y_low,y_high\n";

std::string table_of(Panel panel) { return figure_table({.name = "f", .panels = {panel}}); }

TEST(FigureTableTest, EveryValueIsARowAndAGapIsAnEmptyCell) {
  Panel panel{.x = {.label = "time [s]"}, .y = {.label = "force [N]"}};
  panel.series = {
      {.label = "motor", .x = {0.0, 0.5}, .y = {1.25, std::numeric_limits<double>::quiet_NaN()}},
      {.label = "band", .kind = Kind::kBand, .x = {2}, .y_low = {-1}, .y_high = {3}}};
  EXPECT_EQ(table_of(panel), kHead + std::string("1,time [s],force [N],motor,0,,1.25,,\n"
                                                 "1,time [s],force [N],motor,0.5,,,,\n"
                                                 "1,time [s],force [N],band,2,,,-1,3\n"));
}

TEST(FigureTableTest, ABoxIsOneRowANumberAndACategoryIsNamed) {
  Panel panel{.x = {.ticks = {{1.0, "A"}, {2.0, "B"}}}};
  panel.series = {{.kind = Kind::kBox, .boxes = {{1.8, 1, 2, 3, 4, 5}}}};
  EXPECT_EQ(table_of(panel),
            kHead + std::string("1,,,low,1.8,B,1,,\n1,,,lower quartile,1.8,B,2,,\n"
                                "1,,,median,1.8,B,3,,\n1,,,upper quartile,1.8,B,4,,\n"
                                "1,,,high,1.8,B,5,,\n"));
}

TEST(FigureTableTest, ATextWithACommaOrAQuoteIsOneCell) {
  Panel panel{.y = {.label = "a, b"}};
  panel.series = {{.label = "5\" stick", .x = {1}, .y = {2}}};
  EXPECT_EQ(table_of(panel), kHead + std::string("1,,\"a, b\",\"5\"\" stick\",1,,2,,\n"));
}

}  // namespace stillhand::report::figure_table_test
