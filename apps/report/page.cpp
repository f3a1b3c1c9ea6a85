// SPDX-License-Identifier: Apache-2.0
#include "apps/report/page.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/report/page_style.hpp"
#include "apps/report/plot/svg.hpp"
#include "apps/report/text.hpp"
#include "services/contract/expects.hpp"
#include "services/recording/file_io.hpp"

namespace stillhand::report {
namespace {

constexpr std::size_t kLongValue = 26;  // characters; longer ones have a line of their own

std::string element(const std::string& tag, std::string_view text) {
  return "<" + tag + ">" + html_escaped(text) + "</" + tag + ">\n";
}

const char* class_of(Emphasis emphasis) {
  switch (emphasis) {
    case Emphasis::kStrong:
      return " strong";
    case Emphasis::kGood:
      return " good";
    case Emphasis::kBad:
      return " bad";
    case Emphasis::kFaint:
      return " faint";
    case Emphasis::kNone:
      break;
  }
  return "";
}

const char* class_of(const Table& table, std::size_t column) {
  const Align align = column < table.align.size() ? table.align[column]
                      : column == 0               ? Align::kLeft
                                                  : Align::kRight;
  if (align == Align::kLeft) return "l";
  return align == Align::kRight ? "r" : "c";
}

std::string row_html(const Table& table, const std::vector<Cell>& cells) {
  const std::size_t columns = std::max(cells.size(), table.header.size());
  std::string html = "<tr>";
  for (std::size_t i = 0; i < columns; ++i) {
    const Cell cell = i < cells.size() ? cells[i] : Cell();
    html += std::string("<td class=\"") + class_of(table, i) + class_of(cell.emphasis) + "\">" +
            html_escaped(cell.text) + "</td>";
  }
  return html + "</tr>\n";
}

std::string head_html(const Table& table) {
  if (table.header.empty()) return {};
  std::string html = "<thead><tr>";
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    html += std::string("<th scope=\"col\" class=\"") + class_of(table, i) + "\">" +
            html_escaped(table.header[i]) + "</th>";
  }
  return html + "</tr></thead>\n";
}

}  // namespace

Page::Page(std::string title, std::string lead)
    : title_(std::move(title)), lead_(std::move(lead)) {}

void Page::facts(const std::vector<std::pair<std::string, std::string>>& pairs) {
  facts_ += "<dl>\n";
  for (const auto& [name, value] : pairs) {
    facts_ += std::string(value.size() > kLongValue ? "<div class=\"wide\">" : "<div>") + "<dt>" +
              html_escaped(name) + "</dt><dd>" + html_escaped(value) + "</dd></div>\n";
  }
  facts_ += "</dl>\n";
}

void Page::section(std::string_view heading, int level) {
  STILLHAND_EXPECTS(level == 2 || level == 3);
  const std::string id = "section-" + std::to_string(headings_.size() + 1);
  headings_.push_back({std::string(heading), id, level});
  const std::string tag = "h" + std::to_string(level);
  body_ += "<" + tag + " id=\"" + id + "\">" + html_escaped(heading) + "</" + tag + ">\n";
}

void Page::paragraph(std::string_view text) { body_ += element("p", text); }

void Page::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += element("li", item);
  body_ += "</ul>\n";
}

void Page::warning(std::string_view text) {
  body_ += "<div class=\"warning\" role=\"note\"><strong>Note.</strong> " + html_escaped(text) +
           "</div>\n";
}

void Page::table(const Table& table) {
  const std::string number = std::to_string(++tables_);
  body_ += "<figure class=\"table\" id=\"table-" + number + "\">\n<figcaption><b>Table " + number +
           ".</b> " + html_escaped(table.caption) + "</figcaption>\n";
  body_ += "<div class=\"scroll\" tabindex=\"0\"><table>\n" + head_html(table) + "<tbody>\n";
  for (const std::vector<Cell>& cells : table.rows) body_ += row_html(table, cells);
  body_ += "</tbody></table></div>\n</figure>\n";
}

void Page::figure(const Drawing& drawing) {
  const std::string number = std::to_string(++figures_);
  body_ += "<figure id=\"figure-" + number + "\">\n<div class=\"scroll card\" tabindex=\"0\">" +
           inline_svg(drawing.svg, drawing.caption.empty() ? drawing.name : drawing.caption,
                      drawing.width_px) +
           "</div>\n<figcaption><b>Figure " + number + ".</b> " + html_escaped(drawing.caption) +
           "</figcaption>\n</figure>\n";
}

std::string Page::contents() const {
  if (headings_.size() < 2) return {};
  std::string html = "<nav aria-label=\"Contents\"><h2>Contents</h2>\n<ul>\n";
  for (const Heading& heading : headings_) {
    html += "<li class=\"level" + std::to_string(heading.level) + "\"><a href=\"#" + heading.id +
            "\">" + html_escaped(heading.text) + "</a></li>\n";
  }
  return html + "</ul></nav>\n";
}

std::string Page::html() const {
  // The policy makes the browser see to it that nothing is loaded and no script runs.
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "style-src 'unsafe-inline'\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta name=\"color-scheme\" content=\"light dark\"/>\n";
  html += element("title", title_);
  html += "<style>\n" + std::string(kPageStyle) + "</style>\n</head>\n<body>\n";
  html += contents() + "<main>\n<header>\n" + element("h1", title_);
  if (!lead_.empty()) html += "<p class=\"lead\">" + html_escaped(lead_) + "</p>\n";
  return html + facts_ + "</header>\n" + body_ + "</main>\n</body>\n</html>\n";
}

void Page::write(const std::filesystem::path& path) const {
  const recording::Status status = recording::write_file_atomically(path.string(), html());
  if (!status.ok()) throw std::runtime_error(status.text);
}

}  // namespace stillhand::report
