// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/draw.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>

#include "apps/libraries/report/plot/figure_table.hpp"
#include "apps/libraries/report/plot/gnuplot.hpp"
#include "apps/libraries/report/plot/gnuplot_script.hpp"
#include "apps/libraries/report/plot/panel_layout.hpp"
#include "apps/libraries/report/plot/svg.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/contract/expects.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::report {
namespace {

constexpr std::size_t kProcesses = 2;  // start-up and fonts cost each process 40 ms
constexpr int kOutputsPerFigure = 2;

// The PNG has twice the pixels; its fonts are in points of 1/72 inch at 96 pixels an inch, the
// SVG's in pixels: 2 * 72 / 96 = 1.5.
std::string canvas_commands(const Figure& figure, const std::string& body, int output) {
  const auto times = [](int px, int factor) { return std::to_string(px * factor); };
  const std::string font = " noenhanced font 'DejaVu Sans," + decimal(kFontSize_px) + "'";
  const std::string size = times(figure.width_px, 1) + "," + times(figure.height_px, 1);
  const std::string size_png = times(figure.width_px, 2) + "," + times(figure.height_px, 2);
  const auto plot = [&](int n) {
    return "set output '" + output_path(n) + "'\nset multiplot\n" + body +
           "unset multiplot\nset output\n";
  };
  return "set terminal svg size " + size + font + " background rgb 'white'\n" + plot(output) +
         "set terminal pngcairo size " + size_png + font +
         " fontscale 1.5 linewidth 2 pointscale 2.4 dashlength 2 background rgb 'white'\n" +
         plot(output + 1);
}

// Figures are dealt out in turn.  Neighbours tend to be alike, so the jobs take equally long.
std::vector<GnuplotJob> jobs_of(std::span<const Figure> figures) {
  std::vector<GnuplotJob> jobs(std::min(kProcesses, figures.size()));
  for (GnuplotJob& job : jobs) job.script = "set encoding utf8\n";
  for (std::size_t i = 0; i < figures.size(); ++i) {
    GnuplotJob& job = jobs[i % jobs.size()];
    const FigureScript script = script_of(figures[i]);
    job.script += script.data + canvas_commands(figures[i], script.body, job.outputs);
    job.script += "undefine $*\n";
    job.outputs += kOutputsPerFigure;
  }
  return jobs;
}

// gnuplot does not always report that it could not write.
void expect_whole(const Figure& figure, const std::string& svg, const std::string& png) {
  constexpr std::string_view kEndOfPng = "IEND\xAE\x42\x60\x82";
  const auto last = svg.find_last_not_of(" \n");
  const bool whole = last != std::string::npos &&
                     std::string_view(svg).substr(0, last + 1).ends_with("</svg>") &&
                     std::string_view(png).ends_with(kEndOfPng);
  if (!whole) {
    throw std::runtime_error("gnuplot: figure " + figure.name +
                             " is incomplete, want an SVG and a PNG (is memory exhausted?)");
  }
}

}  // namespace

void require_gnuplot() {
  const GnuplotJob nothing{"exit\n", 0};
  run_gnuplot({&nothing, 1});
}

std::vector<Drawing> draw(std::span<const Figure> figures) {
  std::set<std::string_view> names;
  for (const Figure& figure : figures) STILLHAND_EXPECTS(names.insert(figure.name).second);
  std::vector<Drawing> drawings;
  if (figures.empty()) return drawings;
  const std::vector<GnuplotJob> jobs = jobs_of(figures);
  const auto outputs = run_gnuplot(jobs);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Figure& figure = figures[i];
    const std::size_t place = kOutputsPerFigure * (i / jobs.size());
    const std::string& svg = outputs[i % jobs.size()][place];
    const std::string& png = outputs[i % jobs.size()][place + 1];
    expect_whole(figure, svg, png);
    drawings.push_back(
        {figure.name, figure.caption, figure.width_px, adapted_svg(svg, figure.name), png});
  }
  return drawings;
}

std::vector<Drawing> render(std::span<const Figure> figures, const std::filesystem::path& folder) {
  std::vector<Drawing> drawings = draw(figures);
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const std::vector<std::string> names = figure_files(drawings[i].name);
    recording::write_file(folder / names[0], drawings[i].svg);
    recording::write_file(folder / names[1], drawings[i].png);
    recording::write_file(folder / names[2], figure_table(figures[i]));
  }
  return drawings;
}

}  // namespace stillhand::report
