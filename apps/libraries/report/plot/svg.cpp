// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/svg.hpp"

#include <algorithm>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report {
namespace {

// For systems without DejaVu Sans; all of these are narrower, so nothing overlaps.
constexpr std::string_view kFonts = "'DejaVu Sans','Liberation Sans',Arial,Helvetica,sans-serif";

void insert_after_all(std::string& text, std::string_view mark, std::string_view added) {
  replace_all(text, mark, std::string(mark) + std::string(added));
}

// Ids and the three ways to refer to one, within one tag.
std::string with_prefix(std::string tag, std::string_view prefix) {
  const std::string front = std::string(prefix) + "-";
  for (const std::string_view mark : {" id='", " id=\"", "href='#", "href=\"#", "url(#"}) {
    insert_after_all(tag, mark, front);
  }
  replace_all(tag, " font-family=\"DejaVu Sans\"", "");
  replace_all(tag, " font-family=\"DejaVu Sans:Bold\"", " font-weight=\"bold\"");
  return tag;
}

bool is(std::string_view tag, std::string_view name) {
  return tag.starts_with(name) &&
         (tag.size() == name.size() ||
          std::string_view(" \t\n>/").find(tag[name.size()]) != std::string_view::npos);
}

// Removes groups that hold nothing, inner ones first.
void drop_empty_groups(std::string& svg) {
  constexpr std::string_view kEnd = "</g>";
  std::string out;
  std::size_t at = 0;
  while (at < svg.size()) {
    const std::size_t end = svg.find(kEnd, at);
    if (end == std::string::npos) break;
    out.append(svg, at, end - at);
    at = end + kEnd.size();
    const std::size_t last = out.find_last_not_of(" \t\n");
    const std::size_t open = out.rfind('<');
    const bool empty = last != std::string::npos && out[last] == '>' && open != std::string::npos &&
                       out.compare(open, 3, "<g ") == 0;
    if (empty) {
      out.erase(open);
    } else {
      out += kEnd;
    }
  }
  svg = out.append(svg, at);
}

}  // namespace

std::string adapted_svg(std::string_view svg, std::string_view prefix) {
  std::string out;
  out.reserve(svg.size());
  bool in_title = false;
  while (!svg.empty()) {
    const std::size_t open = svg.find('<');
    if (!in_title) out += svg.substr(0, open);
    if (open == std::string_view::npos) break;
    svg.remove_prefix(open);
    const std::size_t close = std::min(svg.find('>'), svg.size() - 1);
    const std::string_view tag = svg.substr(0, close + 1);
    svg.remove_prefix(close + 1);
    if (is(tag, "<title") || is(tag, "</title")) {
      in_title = tag[1] != '/';
    } else if (is(tag, "<svg")) {
      std::string root(tag.substr(0, tag.size() - 1));
      out += with_prefix(root, prefix) + " font-family=\"" + std::string(kFonts) + "\">";
    } else if (!in_title) {
      out += with_prefix(std::string(tag), prefix);
    }
  }
  drop_empty_groups(out);
  return out;
}

std::string inline_svg(std::string_view svg, std::string_view label, int width_px) {
  const std::size_t root = svg.find("<svg");
  if (root == std::string_view::npos) return {};
  return "<svg role=\"img\" aria-label=\"" + html_escaped(label) +
         "\" style=\"--width: " + std::to_string(width_px) + "px\"" +
         std::string(svg.substr(root + 4));
}

}  // namespace stillhand::report
