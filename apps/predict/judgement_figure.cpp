// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/libraries/report/excerpt.hpp"
#include "apps/predict/judgement.hpp"

namespace stillhand::predict {
namespace {

using report::Kind;
using report::Panel;
using report::Series;

struct Excerpt {
  std::size_t first;
  std::size_t end;
};

// |ln| of an excerpt's RMS error over the whole recording's.
double unlike(const Judged& model, const std::vector<double>& measured, Excerpt at) {
  double square = 0.0;
  for (std::size_t n = at.first; n < at.end; ++n) {
    square += std::pow(measured[n] - model.values[n], 2);
  }
  const double rms = std::sqrt(square / static_cast<double>(at.end - at.first));
  return std::abs(std::log((rms + 1e-300) / (model.score.rmse + 1e-300)));
}

// Rows without a gap whose errors are nearest to those of the whole.
Excerpt typical(const Judgement& judgement) {
  const std::vector<double>& measured = judgement.measured.values;
  const std::size_t length =
      std::min(report::excerpt_length(measured, judgement.rate_hz), measured.size());
  const double longest_s = 1.05 * static_cast<double>(length) / judgement.rate_hz;
  Excerpt best{0, length};
  double least = HUGE_VAL;
  for (std::size_t first = 0; first + length <= measured.size();
       first += std::max<std::size_t>(length / 8, 1)) {
    const Excerpt each{first, first + length};
    if (judgement.time_s[each.end - 1] - judgement.time_s[first] > longest_s) continue;
    const double here = unlike(judgement.carried, measured, each) +
                        (judgement.linear ? unlike(*judgement.linear, measured, each) : 0.0);
    if (here >= least) continue;
    least = here;
    best = each;
  }
  return best;
}

std::vector<double> cut(const std::vector<double>& x, Excerpt at) {
  return {x.begin() + static_cast<std::ptrdiff_t>(at.first),
          x.begin() + static_cast<std::ptrdiff_t>(at.end)};
}

std::string label(const char* name, const Score& score, const std::string& unit) {
  return fmt::format("{}: RMSE {:.3g} {}, VAF {:.1f} %", name, score.rmse, unit, score.vaf_percent);
}

void add_model(const char* name, const Judged& model, report::Colour colour, Kind kind,
               const Judgement& judgement, Excerpt at, Panel& above, Panel& below) {
  const std::vector<double> measured = cut(judgement.measured.values, at);
  Series line{.label = label(name, model.score, judgement.measured.unit),
              .kind = kind,
              .colour = colour,
              .x = cut(judgement.time_s, at),
              .y = cut(model.values, at),
              .line_width_px = 1.5};
  above.series.push_back(line);
  for (std::size_t n = 0; n < measured.size(); ++n) line.y[n] = measured[n] - line.y[n];
  line.kind = Kind::kLine;
  line.show_in_legend = false;
  below.series.push_back(std::move(line));
}

}  // namespace

report::Figure judgement_figure(const Judgement& judgement) {
  const Excerpt at = typical(judgement);
  const recording::Column& output = judgement.measured;
  const std::string unit = output.unit.empty() ? "" : " [" + output.unit + "]";
  Panel above;
  Panel below;
  above.y.label = output.name + unit;
  below.y.label = "measured - model" + unit;
  below.x.label = "time [s]";
  above.series.push_back({.label = "measured",
                          .colour = report::Colour::kMeasured,
                          .x = cut(judgement.time_s, at),
                          .y = cut(output.values, at),
                          .line_width_px = 2.2});
  const bool without_effects =
      judgement.linear && judgement.linear->values == judgement.carried.values;
  if (judgement.linear && !without_effects) {
    add_model("linear", *judgement.linear, report::Colour::kWarning, Kind::kDashedLine, judgement,
              at, above, below);
  }
  add_model(without_effects ? "linear, no effect is saved" : "with effects", judgement.carried,
            report::Colour::kAccent, Kind::kLine, judgement, at, above, below);
  for (Panel* panel : {&above, &below}) {
    panel->x.low = judgement.time_s[at.first];
    panel->x.high = judgement.time_s[at.end - 1];
  }
  return {.name = "prediction", .panels = {above, below}, .width_px = 980, .height_px = 560};
}

}  // namespace stillhand::predict
