// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/libraries/report/page_style.hpp"
#include "apps/libraries/report/plot/svg.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/contract/expects.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::report {
namespace {

constexpr std::size_t kLongValue = 26;  // characters; a longer value has its own line

std::string element(std::string_view tag, std::string_view text) {
  return fmt::format("<{0}>{1}</{0}>\n", tag, html_escaped(text));
}

const char* class_of(Emphasis emphasis) {
  constexpr std::array kClasses{"", " strong", " good", " bad", " faint"};
  return kClasses.at(static_cast<std::size_t>(emphasis));
}

Align align_of(const Table& table, std::size_t column) {
  if (column < table.align.size()) return table.align[column];
  return column == 0 ? Align::kLeft : Align::kRight;
}

const char* class_of(const Table& table, std::size_t column) {
  const Align align = align_of(table, column);
  if (align == Align::kLeft) return "l";
  return align == Align::kRight ? "r" : "c";
}

// Of UTF-8.
std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char each) { return (each & 0xC0) != 0x80; }));
}

// A name of a file as a relative reference, RFC 3986: "./" so that no colon makes a scheme of it.
std::string reference_to(std::string_view file) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  std::string out = "./";
  for (const char each : file) {
    if (kPlain.find(each) != std::string_view::npos) {
      out += each;
    } else {
      out += fmt::format("%{:02X}", static_cast<unsigned char>(each));
    }
  }
  return out;
}

std::string anchor(std::string_view href, std::string_view escaped_text) {
  return fmt::format(R"(<a href="{}">{}</a>)", href, escaped_text);
}

std::string row_html(const Table& table, const std::vector<Cell>& cells) {
  const std::size_t columns = std::max(cells.size(), table.header.size());
  std::string html = "<tr>";
  for (std::size_t i = 0; i < columns; ++i) {
    const Cell cell = i < cells.size() ? cells[i] : Cell();
    const std::string text = html_escaped(cell.text);
    html += fmt::format(R"(<td class="{}{}">{}</td>)", class_of(table, i), class_of(cell.emphasis),
                        cell.href.empty() ? text : anchor(cell.href, text));
  }
  return html + "</tr>\n";
}

std::string head_html(const Table& table) {
  if (table.header.empty()) return {};
  std::string html = "<thead><tr>";
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    html += fmt::format(R"(<th scope="col" class="{}">{}</th>)", class_of(table, i),
                        html_escaped(table.header[i]));
  }
  return html + "</tr></thead>\n";
}

}  // namespace

Cell linked(std::string text, std::string_view file) {
  Cell out(std::move(text));
  out.href = reference_to(file);
  return out;
}

std::string in_plain_text(const Table& table) {
  std::vector<std::vector<Cell>> lines{{table.header.begin(), table.header.end()}};
  lines.insert(lines.end(), table.rows.begin(), table.rows.end());
  std::vector<std::size_t> widths(table.header.size());
  for (const std::vector<Cell>& line : lines) {
    STILLHAND_EXPECTS(line.size() <= widths.size());
    for (std::size_t i = 0; i < line.size(); ++i) {
      widths[i] = std::max(widths[i], characters(line[i].text));
    }
  }
  std::string text = table.caption + '\n';
  for (const std::vector<Cell>& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const std::string space(widths[i] - characters(line[i].text), ' ');
      if (i > 0) row += "   ";
      row += align_of(table, i) == Align::kLeft ? line[i].text + space : space + line[i].text;
    }
    text += row.substr(0, row.find_last_not_of(' ') + 1) + '\n';
  }
  return text;
}

Page::Page(std::string title, std::string lead)
    : title_(std::move(title)), lead_(std::move(lead)) {}

void Page::banner(std::string_view text) {
  head_ += fmt::format("<div class=\"warning\" role=\"note\"><strong>{}</strong></div>\n",
                       html_escaped(text));
}

void Page::facts(const std::vector<std::pair<std::string, std::string>>& pairs) {
  head_ += "<dl>\n";
  for (const auto& [name, value] : pairs) {
    head_ += fmt::format("<div{}><dt>{}</dt><dd>{}</dd></div>\n",
                         value.size() > kLongValue ? R"( class="wide")" : "", html_escaped(name),
                         html_escaped(value));
  }
  head_ += "</dl>\n";
}

void Page::section(std::string_view heading, int level) {
  STILLHAND_EXPECTS(level == 2 || level == 3);
  const std::string id = fmt::format("section-{}", headings_.size() + 1);
  headings_.push_back({std::string(heading), id, level});
  body_ += fmt::format("<h{0} id=\"{1}\">{2}</h{0}>\n", level, id, html_escaped(heading));
}

void Page::paragraph(std::string_view text) { body_ += element("p", text); }

void Page::link(std::string_view text, std::string_view file) {
  body_ += fmt::format("<p>{}</p>\n", anchor(reference_to(file), html_escaped(text)));
}

void Page::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += element("li", item);
  body_ += "</ul>\n";
}

void Page::warning(std::string_view text) {
  body_ += fmt::format("<div class=\"warning\" role=\"note\"><strong>Note.</strong> {}</div>\n",
                       html_escaped(text));
}

void Page::table(const Table& table) {
  body_ += fmt::format(
      "<figure class=\"table\" id=\"table-{0}\">\n<figcaption><b>Table {0}.</b> {1}</figcaption>\n"
      "<div class=\"scroll\" tabindex=\"0\"><table>\n{2}<tbody>\n",
      ++tables_, html_escaped(table.caption), head_html(table));
  for (const std::vector<Cell>& cells : table.rows) {
    STILLHAND_EXPECTS(table.header.empty() || cells.size() <= table.header.size());
    body_ += row_html(table, cells);
  }
  body_ += "</tbody></table></div>\n</figure>\n";
}

void Page::figure(const Drawing& drawing) {
  const std::string& label = drawing.caption.empty() ? drawing.name : drawing.caption;
  body_ += fmt::format(
      "<figure id=\"figure-{0}\">\n<div class=\"scroll card\" tabindex=\"0\">{1}</div>\n"
      "<figcaption><b>Figure {0}.</b> {2}</figcaption>\n</figure>\n",
      ++figures_, inline_svg(drawing.svg, label, drawing.width_px), html_escaped(drawing.caption));
}

std::string Page::contents() const {
  if (headings_.size() < 2) return {};
  std::string html = "<nav aria-label=\"Contents\"><h2>Contents</h2>\n<ul>\n";
  for (const Heading& heading : headings_) {
    html += fmt::format("<li class=\"level{}\"><a href=\"#{}\">{}</a></li>\n", heading.level,
                        heading.id, html_escaped(heading.text));
  }
  return html + "</ul></nav>\n";
}

std::string Page::html() const {
  // With this policy the browser loads nothing and runs no script.
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "style-src 'unsafe-inline'\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta name=\"color-scheme\" content=\"light dark\"/>\n";
  html += element("title", title_);
  html += "<style>\n" + page_style() + "</style>\n</head>\n<body>\n";
  html += contents() + "<main>\n<header>\n" + element("h1", title_);
  if (!lead_.empty()) html += fmt::format("<p class=\"lead\">{}</p>\n", html_escaped(lead_));
  return html + head_ + "</header>\n" + body_ + "</main>\n</body>\n</html>\n";
}

void Page::write(const std::filesystem::path& path) const { recording::write_file(path, html()); }

}  // namespace stillhand::report
