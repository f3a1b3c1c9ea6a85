// SPDX-License-Identifier: Apache-2.0
#include "apps/measurement/tables/text_cells.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include "apps/measurement/tables/titles.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::size_t kLongestNumber = 64;
constexpr std::size_t kQuotedBytes = 40;

bool is_blank(char c) { return c == ' ' || c == '\t'; }

bool is_missing(std::string_view text) {
  constexpr std::array<std::string_view, 9> kWords{"nan",  "na", "n/a", "#n/a", "null",
                                                   "none", "-",  "--",  "?"};
  if (text.empty()) return true;
  if (text.size() > 4) return false;
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return std::ranges::find(kWords, lower) != kWords.end();
}

void split_at_blanks(std::string_view line, std::vector<std::string_view>& cells) {
  for (std::size_t at = 0;;) {
    while (at < line.size() && is_blank(line[at])) ++at;
    if (at == line.size()) return;
    std::size_t end = at;
    while (end < line.size() && !is_blank(line[end])) ++end;
    cells.push_back(line.substr(at, end - at));
    at = end;
  }
}

}  // namespace

bool TextLines::next(TextLine& line) {
  if (offset_ >= text_.size()) return false;
  const void* end = std::memchr(text_.data() + offset_, '\n', text_.size() - offset_);
  line.ended = end != nullptr;
  const std::size_t length =
      line.ended ? static_cast<std::size_t>(static_cast<const char*>(end) - text_.data()) - offset_
                 : text_.size() - offset_;
  line.text = text_.substr(offset_, length);
  if (line.text.ends_with('\r')) line.text.remove_suffix(1);
  line.number = number_++;
  line.offset = offset_;
  offset_ += length + 1;
  return true;
}

void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == ' ') {
    split_at_blanks(line, cells);
    return;
  }
  bool in_quotes = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') in_quotes = !in_quotes;
    if (line[i] != separator || in_quotes) continue;
    cells.push_back(line.substr(start, i - start));
    start = i + 1;
  }
  cells.push_back(line.substr(start));
}

CellContent read_cell(std::string_view cell, char decimal, double& number) {
  std::string_view text = plain_cell(cell);
  if (is_missing(text)) return CellContent::kMissing;
  if (text.size() > kLongestNumber) return CellContent::kText;
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  std::array<char, kLongestNumber> point{};
  if (decimal != '.') {
    if (text.find('.') != std::string_view::npos) return CellContent::kText;
    std::ranges::replace_copy(text, point.begin(), decimal, '.');
    text = {point.data(), text.size()};
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && std::isfinite(number) ? CellContent::kNumber : CellContent::kText;
}

bool is_comment(std::string_view line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

std::string quoted(std::string_view text) {
  std::size_t end = std::min(text.size(), kQuotedBytes);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
    --end;  // not within a character
  }
  return "'" + std::string(text.substr(0, end)) + (end == text.size() ? "'" : "...'");
}

}  // namespace stillhand::measurement
