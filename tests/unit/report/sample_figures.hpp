// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"
#include "apps/libraries/report/plot/palette.hpp"
#include "tests/support/folder.hpp"

/// Figures with known content, and judges of what was drawn.
namespace stillhand::report::test {

/// One panel with one series of each kind, and every kind of note and line.
inline Figure every_kind() {
  Panel panel{.title = "every kind"};
  panel.x.label = "time [s]";
  panel.y.label = "acceleration [m/s²]";
  panel.reference_lines = {{Direction::kHorizontal, 1.5, "level"},
                           {Direction::kVertical, 2.5, "moment"}};
  panel.notes = {{"corner", Corner::kBottomRight},
                 {"point", Corner::kTopLeft, std::pair{2.0, 2.0}}};
  int colour = 0;
  for (const Kind kind :
       {Kind::kBand, Kind::kLine, Kind::kDashedLine, Kind::kDottedLine, Kind::kPoints,
        Kind::kLineAndPoints, Kind::kSteps, Kind::kErrorBars, Kind::kBars}) {
    panel.series.push_back(Series{.label = "series " + std::to_string(colour),
                                  .kind = kind,
                                  .colour = static_cast<Colour>(colour),
                                  .x = {1, 2, 3},
                                  .y = {1, 2, 1.5},
                                  .y_low = {0.5, 1.5, 1},
                                  .y_high = {1.5, 2.5, 2}});
    ++colour;
  }
  panel.series.push_back(Series{.label = "boxes",
                                .kind = Kind::kBox,
                                .colour = static_cast<Colour>(colour),
                                .boxes = {{4, 0.5, 1, 1.5, 2, 2.5}}});
  return {.name = "every_kind", .caption = "Every kind.", .panels = {panel}};
}

/// One line in the colour of condition A.
inline Figure one_line(const std::vector<double>& y) {
  Series line{.colour = Colour::kConditionA, .y = y};
  for (std::size_t i = 0; i < y.size(); ++i) line.x.push_back(static_cast<double>(i));
  return {.name = "one_line", .panels = {Panel{.series = {line}}}};
}

/// "rgb( 17,  17,  17)": how gnuplot's SVG writes a role's colour.
inline std::string svg_colour(Colour colour) {
  const std::string rgb(look(colour).rgb);
  std::string text = "rgb(";
  for (std::size_t i = 1; i < 7; i += 2) {
    const std::string part = std::to_string(std::stoi(rgb.substr(i, 2), nullptr, 16));
    text += std::string(3 - part.size(), ' ') + part + (i < 5 ? ", " : ")");
  }
  return text;
}

/// Path data of every stroke in a colour.
inline std::vector<std::string> strokes(const std::string& svg, Colour colour) {
  std::vector<std::string> found;
  const std::string mark = "<path stroke='" + svg_colour(colour) + "'";
  for (std::size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + 1)) {
    const std::size_t begin = svg.find(" d='", at) + 4;
    found.push_back(svg.substr(begin, svg.find('\'', begin) - begin));
  }
  return found;
}

/// Every value of an attribute, whichever quotes it has.  (Not std::regex: under a sanitizer GCC 12
/// takes its innards for uninitialised.)
inline std::vector<std::string> attributes(const std::string& text, const std::string& name) {
  std::vector<std::string> values;
  const std::string mark = " " + name + "=";
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos;) {
    at += mark.size();
    const std::size_t end = text.find(text[at], at + 1);
    values.push_back(text.substr(at + 1, end - at - 1));
  }
  return values;
}

using TemporaryFolder = support::Folder;

/// Whether a strict XML parser (expat, by way of Python) reads the whole text.
inline bool well_formed(const std::string& text) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "text.xml";
  std::ofstream(file) << text;
  const std::string command =
      "python3 -c 'import sys,xml.parsers.expat as e;e.ParserCreate().ParseFile(open(sys.argv[1],"
      "\"rb\"))' " +
      file.string();
  return std::system(command.c_str()) == 0;
}

}  // namespace stillhand::report::test
