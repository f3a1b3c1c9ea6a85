// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/series_script.hpp"

#include <initializer_list>

#include "apps/libraries/report/plot/palette.hpp"
#include "apps/libraries/report/plot/thinning.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::report {
namespace {

// gnuplot's point size that makes a mark of point_size 1 about 7 px wide on both terminals.
constexpr double kPointScale = 0.62;
constexpr double kErrorBarCap_px = 3.5;  // half the width

std::string row(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += ' ';
    text += decimal(value);
  }
  return text + '\n';
}

// The arrays that a kind reads, and how to write point i.
struct Columns {
  std::vector<const std::vector<double>*> y;
  bool continuous = true;  ///< drawn as a line, so that neighbours matter
};

Columns columns_of(const Series& series) {
  switch (series.kind) {
    case Kind::kBand:
      return {{&series.y_low, &series.y_high}, true};
    case Kind::kErrorBars:
      return {{&series.y, &series.y_low, &series.y_high}, false};
    case Kind::kPoints:
    case Kind::kBars:
      return {{&series.y}, false};
    default:
      return {{&series.y}, true};
  }
}

class Rows {
 public:
  Rows(const Series& series, const PanelLayout& layout)
      : series_(series), layout_(layout), columns_(columns_of(series)) {
    for (const auto* y : columns_.y) STILLHAND_EXPECTS(y->size() == series.x.size());
  }

  std::string text() {
    for (std::size_t i = 0; i < series_.x.size(); ++i) {
      if (drawable(i)) {
        run_.push_back(i);
      } else {
        end_run();
      }
    }
    end_run();
    return text_;
  }

 private:
  bool drawable(std::size_t i) const {
    if (!layout_.x.drawable(series_.x[i])) return false;
    for (const auto* y : columns_.y) {
      if (!layout_.y.drawable((*y)[i])) return false;
    }
    return true;
  }

  double column_px(std::size_t i) const {
    return layout_.x.fraction(series_.x[i]) * layout_.plot.width();
  }

  // Positions within run_ that are drawn.
  std::vector<std::size_t> thinned() const {
    const bool line = series_.kind == Kind::kLine || series_.kind == Kind::kDashedLine ||
                      series_.kind == Kind::kDottedLine || series_.kind == Kind::kBand ||
                      series_.kind == Kind::kSteps;
    std::vector<double> column;
    std::vector<double> low;
    std::vector<double> high;
    for (const std::size_t i : run_) {
      column.push_back(column_px(i));
      low.push_back((*columns_.y.front())[i]);
      high.push_back((*columns_.y.back())[i]);
    }
    if (line) return thin_line(column, low, high, layout_.plot.width());
    for (double& y : low) y = layout_.y.fraction(y) * layout_.plot.height();
    return thin_points(column, low);
  }

  void end_run() {
    if (run_.empty()) return;
    if (!text_.empty() && columns_.continuous) text_ += '\n';
    const bool thin = run_.size() > kThinAbove && series_.kind != Kind::kBars &&
                      series_.kind != Kind::kErrorBars && series_.kind != Kind::kLineAndPoints;
    if (thin) {
      for (const std::size_t k : thinned()) add(run_[k]);
    } else {
      for (const std::size_t i : run_) add(i);
    }
    run_.clear();
  }

  void add(std::size_t i) {
    const double x = series_.x[i];
    switch (series_.kind) {
      case Kind::kBand:
        text_ += row({x, series_.y_low[i], series_.y_high[i]});
        break;
      case Kind::kErrorBars:
        text_ +=
            row({x, series_.y[i], series_.y_low[i], 0.0, series_.y_high[i] - series_.y_low[i]});
        break;
      case Kind::kBars:
        text_ += row({x, series_.y[i], series_.bar_width});
        break;
      default:
        text_ += row({x, series_.y[i]});
    }
  }

  const Series& series_;
  const PanelLayout& layout_;
  Columns columns_;
  std::vector<std::size_t> run_;
  std::string text_;
};

std::string fill_style(const Series& series, bool border) {
  std::string style = " fillstyle transparent solid " + decimal(fill_density(series.kind)) + " ";
  return style + (border ? "border" + colour_style(series) : "noborder");
}

std::string block_text(const std::string& block, const std::string& rows) {
  return block + " << EOD\n" + rows + "EOD\n";
}

SeriesScript box_script(const Series& series, const PanelLayout& layout, const std::string& block) {
  std::string boxes;
  for (const Box& box : series.boxes) {
    const auto drawable = [&](double value) { return layout.y.drawable(value); };
    if (!layout.x.drawable(box.at)) continue;
    if (drawable(box.low) && drawable(box.lower_quartile) && drawable(box.median) &&
        drawable(box.upper_quartile) && drawable(box.high)) {
      boxes += row({box.at, box.low, box.lower_quartile, box.median, box.upper_quartile, box.high,
                    series.bar_width});
    }
  }
  SeriesScript script;
  if (!boxes.empty()) {
    script.data += block_text(block, boxes);
    script.clauses.push_back(block + " using 1:3:2:6:5:7 with candlesticks whiskerbars 0.5" +
                             line_style(series) + fill_style(series, true));
    script.clauses.push_back(block + " using 1:4:4:4:4:7 with candlesticks lw 2.6" +
                             colour_style(series));
  }
  return script;
}

std::string clause(const Series& series, double plot_width_px) {
  switch (series.kind) {
    case Kind::kBand:
      return "using 1:2:3 with filledcurves" + colour_style(series) + fill_style(series, false);
    case Kind::kErrorBars:
      // Not yerrorbars: that wipes a disc around each point.  Arrows with flat heads instead.
      return "using 1:3:4:5 with vectors heads fixed size graph " +
             decimal(kErrorBarCap_px / plot_width_px) + ",90" + line_style(series);
    case Kind::kBars:
      return "using 1:2:3 with boxes" + line_style(series) + fill_style(series, true);
    case Kind::kSteps:
      return "using 1:2 with steps" + line_style(series);
    case Kind::kPoints:
      return "using 1:2 with points" + point_style(series) + colour_style(series);
    case Kind::kLineAndPoints:
      return "using 1:2 with linespoints" + line_style(series) + point_style(series);
    default:
      return "using 1:2 with lines" + line_style(series);
  }
}

}  // namespace

std::string line_style(const Series& series) {
  const std::string style = " lw " + decimal(series.line_width_px) + colour_style(series);
  if (series.kind == Kind::kDashedLine) return style + " dt (7,4)";
  if (series.kind == Kind::kDottedLine) return style + " dt (1.5,3.5)";
  return style + " dt solid";
}

std::string point_style(const Series& series) {
  return " pt " + std::to_string(look(series.colour).point_type) + " ps " +
         decimal(series.point_size * kPointScale);
}

std::string colour_style(const Series& series) {
  return " lc rgb '" + std::string(look(series.colour).rgb) + "'";
}

double fill_density(Kind kind) {
  if (kind == Kind::kBars) return 0.75;
  return kind == Kind::kBox ? 0.3 : 0.22;
}

SeriesScript series_script(const Series& series, const PanelLayout& layout,
                           const std::string& block) {
  if (series.kind == Kind::kBox) return box_script(series, layout, block);
  const std::string rows = Rows(series, layout).text();
  if (rows.empty()) return {};
  SeriesScript script{block_text(block, rows), {block + " " + clause(series, layout.plot.width())}};
  if (series.kind == Kind::kErrorBars) {
    script.clauses.push_back(block + " using 1:2 with points" + point_style(series) +
                             colour_style(series));
  }
  return script;
}

}  // namespace stillhand::report
