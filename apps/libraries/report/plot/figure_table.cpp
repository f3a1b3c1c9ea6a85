// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/figure_table.hpp"

#include <algorithm>
#include <cmath>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report {
namespace {

std::string cell(std::string_view text) { return csv_quoted(clean(text)); }

std::string number_at(const std::vector<double>& values, std::size_t i) {
  return i < values.size() && std::isfinite(values[i]) ? decimal(values[i]) : std::string();
}

// The category nearest to x: marks of one category stand side by side.
std::string category_of(const Axis& axis, double x) {
  const auto nearest = std::ranges::min_element(
      axis.ticks, {}, [&](const AxisTick& tick) { return std::abs(tick.at - x); });
  return nearest == axis.ticks.end() ? std::string() : cell(nearest->label);
}

void add_boxes(const Series& series, const std::string& begin, const Axis& x, std::string& table) {
  const auto row = [&](const char* which, double at, double value) {
    table += begin + cell(series.label + (series.label.empty() ? "" : ", ") + which) + ',' +
             decimal(at) + ',' + category_of(x, at) + ',' + number_at({value}, 0) + ",,\n";
  };
  for (const Box& box : series.boxes) {
    row("low", box.at, box.low);
    row("lower quartile", box.at, box.lower_quartile);
    row("median", box.at, box.median);
    row("upper quartile", box.at, box.upper_quartile);
    row("high", box.at, box.high);
  }
}

void add_points(const Series& series, const std::string& begin, const Axis& x, std::string& table) {
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    table += begin + cell(series.label) + ',' + number_at(series.x, i) + ',' +
             category_of(x, series.x[i]) + ',' + number_at(series.y, i) + ',' +
             number_at(series.y_low, i) + ',' + number_at(series.y_high, i) + '\n';
  }
}

}  // namespace

std::string figure_table(const Figure& figure) {
  std::string table = "panel,x_axis,y_axis,series,x,x_label,y,y_low,y_high\n";
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const Panel& panel = figure.panels[p];
    const std::string begin =
        std::to_string(p + 1) + ',' + cell(panel.x.label) + ',' + cell(panel.y.label) + ',';
    for (const Series& series : panel.series) {
      if (series.kind == Kind::kBox) {
        add_boxes(series, begin, panel.x, table);
      } else {
        add_points(series, begin, panel.x, table);
      }
    }
  }
  return table;
}

std::vector<std::string> figure_files(const std::string& name) {
  return {name + ".svg", name + ".png", name + ".csv"};
}

}  // namespace stillhand::report
