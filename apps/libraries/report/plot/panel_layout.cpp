// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/panel_layout.hpp"

#include <algorithm>
#include <cmath>

#include "apps/libraries/report/plot/legend_layout.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report {
namespace {

constexpr double kEdge_px = 6.0;
constexpr double kBetweenColumns_px = 18.0;
constexpr double kBetweenRows_px = 12.0;
constexpr double kRight_px = 16.0;
constexpr double kTitle_px = 24.0;
constexpr double kNoTitle_px = 8.0;
constexpr double kAxisLabel_px = 21.0;
constexpr double kTickLabels_px = 24.0;  // below the plot
constexpr double kLeastPlot_px = 30.0;
constexpr double kMostMargin = 0.45;        // share of a panel; labels longer than that are cut off
constexpr double kLegendPadding_px = 14.0;  // of a legend inside the plot, left and right together
// Above and below a plot, for guesses of its height before the legend's rows are known.
constexpr double kUsualMargins_px = 60.0;
// Sine and cosine of kSlant_deg.
constexpr double kSlantSine = 0.5;
constexpr double kSlantCosine = 0.866;

struct Margins {
  double left_px = 0.0;
  double top_px = 0.0;
  double bottom_px = 0.0;
};

double widest_label_px(const AxisLayout& axis) {
  double widest_px = 0.0;
  for (const AxisTick& tick : axis.major) {
    widest_px = std::max(widest_px, text_width_px(tick.label, kFontSize_px));
  }
  return widest_px;
}

bool labels_collide(const AxisLayout& axis, double length_px) {
  for (std::size_t i = 1; i < axis.major.size(); ++i) {
    const double apart_px =
        (axis.fraction(axis.major[i].at) - axis.fraction(axis.major[i - 1].at)) * length_px;
    const double need_px = 0.5 * (text_width_px(axis.major[i].label, kFontSize_px) +
                                  text_width_px(axis.major[i - 1].label, kFontSize_px));
    if (need_px + 6.0 > apart_px) return true;
  }
  return false;
}

bool inside(Legend legend) { return legend != Legend::kAbove && legend != Legend::kNone; }

// A legend that would fill most of a small plot goes above it.
Legend legend_place(const Panel& panel, double plot_width_px, double plot_height_px) {
  if (!inside(panel.legend)) return panel.legend;
  const LegendBlock block = flow_legend(panel.series, 0.0);
  const bool fits = block.width_px + kLegendPadding_px < 0.8 * plot_width_px &&
                    block.height_px() < 0.6 * plot_height_px;
  return fits ? panel.legend : Legend::kAbove;
}

bool title_shares_row(const Panel& panel, const LegendBlock& block, double plot_width_px) {
  return block.rows == 1 && !panel.title.empty() &&
         text_width_px(panel.title, kFontSize_px) * 1.12 + 24.0 + block.width_px <= plot_width_px;
}

double top_px(const Panel& panel, Legend place, double plot_width_px) {
  const double title_px = panel.title.empty() ? kNoTitle_px : kTitle_px;
  if (place != Legend::kAbove) return title_px;
  const LegendBlock block = flow_legend(panel.series, plot_width_px);
  if (block.rows == 0 || title_shares_row(panel, block, plot_width_px)) return title_px;
  return (panel.title.empty() ? 2.0 : kTitle_px) + block.height_px() + 4.0;
}

void place_legend(const Panel& panel, PanelLayout& layout) {
  const Rectangle& plot = layout.plot;
  const Legend place = layout.legend_place;
  if (place == Legend::kAbove) {
    const LegendBlock block = flow_legend(panel.series, plot.width());
    const bool shared = title_shares_row(panel, block, plot.width());
    const double left_px = shared ? plot.right - block.width_px : plot.left;
    layout.entries = moved(block, left_px, plot.top - 4.0 - block.height_px());
    layout.title_px = plot.top - (shared || block.rows == 0 ? 4.0 + 0.5 * kLegendRow_px
                                                            : 14.0 + block.height_px());
    return;
  }
  layout.title_px = plot.top - 4.0 - 0.5 * kLegendRow_px;
  if (!inside(place)) return;
  const LegendBlock block = flow_legend(panel.series, 0.0);  // one entry a row
  if (block.rows == 0) return;
  const bool left = place == Legend::kTopLeft || place == Legend::kBottomLeft;
  const bool top = place == Legend::kTopLeft || place == Legend::kTopRight;
  const double width_px = block.width_px + kLegendPadding_px;
  const double height_px = block.height_px() + 6.0;
  Rectangle& box = layout.legend;
  box.left = left ? plot.left + 8.0 : plot.right - 8.0 - width_px;
  box.top = top ? plot.top + 6.0 : plot.bottom - 6.0 - height_px;
  box.right = box.left + width_px;
  box.bottom = box.top + height_px;
  layout.entries = moved(block, box.left + 7.0, box.top + 3.0);
}

// Shortens the longer side about the plot's centre until a unit is equally long on both axes.
void make_aspect_equal(PanelLayout& layout) {
  if (layout.x.logarithmic || layout.y.logarithmic) return;
  Rectangle& plot = layout.plot;
  const double x_span = layout.x.high - layout.x.low;
  const double y_span = layout.y.high - layout.y.low;
  const double unit_px = std::min(plot.width() / x_span, plot.height() / y_span);
  const double spare_x_px = plot.width() - unit_px * x_span;
  const double spare_y_px = plot.height() - unit_px * y_span;
  plot.left += 0.5 * spare_x_px;
  plot.right -= 0.5 * spare_x_px;
  plot.top += 0.5 * spare_y_px;
  plot.bottom -= 0.5 * spare_y_px;
}

class Grid {
 public:
  explicit Grid(const Figure& figure)
      : figure_(figure),
        columns_(static_cast<std::size_t>(std::max(1, figure.columns))),
        rows_((figure.panels.size() + columns_ - 1) / columns_),
        cell_width_px_((figure.width_px - 2.0 * kEdge_px -
                        kBetweenColumns_px * (static_cast<double>(columns_) - 1.0)) /
                       static_cast<double>(columns_)),
        panels_(figure.panels.size()),
        margins_(figure.panels.size()) {}

  std::vector<PanelLayout> lay_out() {
    for (std::size_t i = 0; i < panels_.size(); ++i) measure_y(i);
    for (std::size_t i = 0; i < panels_.size(); ++i) measure_x(i);
    place();
    for (std::size_t i = 0; i < panels_.size(); ++i) finish(i);
    return panels_;
  }

 private:
  // Of the margins of every panel in the column (or row) of panel i the largest.
  double column_left_px(std::size_t i) const {
    double left_px = 0.0;
    for (std::size_t k = i % columns_; k < panels_.size(); k += columns_) {
      left_px = std::max(left_px, margins_[k].left_px);
    }
    return left_px;
  }
  // Labels of the y axes of one column are in line.
  double column_labels_px(std::size_t i) const {
    double widest_px = 0.0;
    for (std::size_t k = i % columns_; k < panels_.size(); k += columns_) {
      widest_px = std::max(widest_px, widest_label_px(panels_[k].y));
    }
    return widest_px;
  }
  double row_margin_px(std::size_t row, double Margins::* side) const {
    double most_px = 0.0;
    for (std::size_t k = row * columns_; k < std::min((row + 1) * columns_, panels_.size()); ++k) {
      most_px = std::max(most_px, margins_[k].*side);
    }
    return most_px;
  }

  void measure_y(std::size_t i) {
    const Panel& panel = figure_.panels[i];
    const double height_px =
        std::max(kLeastPlot_px, figure_.height_px / static_cast<double>(rows_) - kUsualMargins_px);
    panels_[i].y = lay_out_axis(panel.y, extent_y(panel), height_px, false, false, kFontSize_px);
    margins_[i].left_px = std::min(kMostMargin * cell_width_px_,
                                   (panel.y.label.empty() ? 0.0 : kAxisLabel_px) +
                                       widest_label_px(panels_[i].y) + kTickToLabel_px + 3.0);
  }

  void measure_x(std::size_t i) {
    const Panel& panel = figure_.panels[i];
    const double width_px = std::max(kLeastPlot_px, cell_width_px_ - column_left_px(i) - kRight_px);
    PanelLayout& layout = panels_[i];
    layout.x = lay_out_axis(panel.x, extent_x(panel), width_px, true, true, kFontSize_px);
    layout.slanted_x_labels = labels_collide(layout.x, width_px);
    const double height_px = figure_.height_px / static_cast<double>(rows_) - kUsualMargins_px;
    const double below_px =
        layout.slanted_x_labels
            ? std::min(kMostMargin * height_px, 14.0 + kSlantSine * widest_label_px(layout.x) + 6.0)
            : kTickLabels_px;
    if (layout.slanted_x_labels && !layout.x.major.empty()) {
      // The first label hangs out to the left of its tick.
      const double hang_px = kSlantCosine * text_width_px(layout.x.major[0].label, kFontSize_px) -
                             layout.x.fraction(layout.x.major[0].at) * width_px;
      margins_[i].left_px =
          std::max(margins_[i].left_px, std::min(kMostMargin * cell_width_px_, hang_px));
    }
    margins_[i].bottom_px = below_px + (panel.x.label.empty() ? 0.0 : kAxisLabel_px - 2.0);
    layout.legend_place = legend_place(panel, width_px, height_px);
    margins_[i].top_px = top_px(panel, layout.legend_place, width_px);
  }

  void place() {
    double free_px =
        figure_.height_px - 2.0 * kEdge_px - kBetweenRows_px * (static_cast<double>(rows_) - 1.0);
    for (std::size_t row = 0; row < rows_; ++row) {
      free_px -= row_margin_px(row, &Margins::top_px) + row_margin_px(row, &Margins::bottom_px);
    }
    const double height_px = std::max(kLeastPlot_px, free_px / static_cast<double>(rows_));
    double top_px = kEdge_px;
    for (std::size_t row = 0; row < rows_; ++row) {
      top_px += row_margin_px(row, &Margins::top_px);
      for (std::size_t i = row * columns_; i < std::min((row + 1) * columns_, panels_.size());
           ++i) {
        const double cell_left_px =
            kEdge_px + static_cast<double>(i % columns_) * (cell_width_px_ + kBetweenColumns_px);
        Rectangle& plot = panels_[i].plot;
        plot.left = cell_left_px + column_left_px(i);
        plot.right = std::max(plot.left + kLeastPlot_px, cell_left_px + cell_width_px_ - kRight_px);
        plot.top = top_px;
        plot.bottom = top_px + height_px;
      }
      top_px += height_px + row_margin_px(row, &Margins::bottom_px) + kBetweenRows_px;
    }
  }

  void finish(std::size_t i) {
    const Panel& panel = figure_.panels[i];
    PanelLayout& layout = panels_[i];
    if (panel.equal_aspect) make_aspect_equal(layout);
    layout.y_label_px =
        layout.plot.left - column_labels_px(i) - kTickToLabel_px - 0.55 * kAxisLabel_px;
    layout.x_label_px = layout.plot.bottom + margins_[i].bottom_px - 0.5 * kAxisLabel_px;
    place_legend(panel, layout);
  }

  const Figure& figure_;
  std::size_t columns_;
  std::size_t rows_;
  double cell_width_px_;
  std::vector<PanelLayout> panels_;
  std::vector<Margins> margins_;
};

}  // namespace

std::vector<PanelLayout> lay_out(const Figure& figure) { return Grid(figure).lay_out(); }

}  // namespace stillhand::report
