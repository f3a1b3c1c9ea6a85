// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/titles.hpp"

#include <algorithm>

#include "apps/libraries/measurement/tables/units.hpp"

namespace stillhand::measurement {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// "name [unit]" with these brackets; false: the text has another form.
bool in_brackets(std::string_view text, char open, char close, Title& out) {
  if (!text.ends_with(close)) return false;
  const std::size_t at = text.rfind(open);
  if (at == std::string_view::npos || at == 0) return false;
  const std::string_view unit = trimmed(text.substr(at + 1, text.size() - at - 2));
  const std::string_view name = trimmed(text.substr(0, at));
  if (unit.empty() || name.empty()) return false;
  out = {std::string(name), std::string(unit)};
  return true;
}

}  // namespace

std::string_view plain_cell(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = trimmed(text.substr(1, text.size() - 2));
  }
  return text;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + names[i];
  }
  return names.size() > kMost ? text + ", ..." : text;
}

Title parse_title(std::string_view title) {
  const std::string_view text = plain_cell(title);
  Title out;
  if (in_brackets(text, '[', ']', out) || in_brackets(text, '(', ')', out)) return out;
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos && slash > 0) {
    const std::string unit(trimmed(text.substr(slash + 1)));
    if (!unit.empty() && is_unit(unit)) {
      return {std::string(trimmed(text.substr(0, slash))), unit};
    }
  }
  return {std::string(text), {}};
}

}  // namespace stillhand::measurement
