// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/text_cells.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>

#include "apps/libraries/measurement/tables/titles.hpp"

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

bool is_whole_number(std::string_view text, double& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
}

// "1.5D+03", as Fortran writes an exponent.
bool is_fortran_number(std::string_view text, double& number) {
  const std::size_t sign = text.find_first_of("Dd");
  if (sign == std::string_view::npos || sign == 0) return false;
  std::string with_e(text);
  with_e[sign] = 'e';
  return is_whole_number(with_e, number);
}

// Fixed digits of a date or a clock, as an int.
bool take_digits(std::string_view& text, std::size_t count, int& value) {
  if (text.size() < count) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + count, value);
  if (error != std::errc() || end != text.data() + count || text.front() == '-') return false;
  text.remove_prefix(count);
  return true;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

// "hh:mm", "hh:mm:ss", "hh:mm:ss.fff" or "hhmmss.fff" (ISO 8601), in [s].
bool take_clock(std::string_view& text, double& seconds) {
  int hour = 0;
  int minute = 0;
  int second = 0;
  if (!take_digits(text, 2, hour)) return false;
  const bool basic = !take(text, ":");
  if (!take_digits(text, 2, minute) || (basic && text.size() < 2)) return false;
  double fraction = 0.0;
  if (basic || take(text, ":")) {
    if (!take_digits(text, 2, second)) return false;
    if (take(text, ".,")) {
      double scale = 0.1;
      for (int digit = 0; take_digits(text, 1, digit); scale /= 10.0) fraction += scale * digit;
    }
  }
  seconds = hour * 3600.0 + minute * 60.0 + second + fraction;
  return hour <= 24 && minute < 60 && second <= 60;
}

// "", "Z", "+hh", "+hhmm" or "+hh:mm": [s] ahead of UTC.
bool is_zone(std::string_view text, double& ahead) {
  ahead = 0.0;
  if (text.empty() || text == "Z") return true;
  const double sign = text.front() == '-' ? -1.0 : 1.0;
  int hour = 0;
  int minute = 0;
  if (!take(text, "+-") || !take_digits(text, 2, hour)) return false;
  take(text, ":");
  if (!text.empty() && !take_digits(text, 2, minute)) return false;
  ahead = sign * (hour * 3600.0 + minute * 60.0);
  return text.empty();
}

// "2026-11-26", "2026/11/26", "20261126" or "26.11.2026", with a blank or a T behind it.
bool take_date(std::string_view& text, int& year, int& month, int& day) {
  std::string_view rest = text;
  const bool by_year = take_digits(rest, 4, year);
  if (by_year && (rest.starts_with('-') || rest.starts_with('/'))) {
    const std::string_view sign = rest.substr(0, 1);
    if (!take(rest, sign) || !take_digits(rest, 2, month) || !take(rest, sign) ||
        !take_digits(rest, 2, day)) {
      return false;
    }
  } else if (by_year) {
    if (!take_digits(rest, 2, month) || !take_digits(rest, 2, day)) return false;
  } else {
    rest = text;
    if (!take_digits(rest, 2, day) || !take(rest, ".") || !take_digits(rest, 2, month) ||
        !take(rest, ".") || !take_digits(rest, 4, year)) {
      return false;
    }
  }
  if (!take(rest, "T ")) return false;
  text = rest;
  return true;
}

// A stamp of ISO 8601: a date and a clock in [s] since 1970 (UTC where it states no zone), or a
// clock alone in [s] since midnight.
bool is_stamp(std::string_view text, double& seconds) {
  int year = 0;
  int month = 0;
  int day = 0;
  double date = 0.0;
  if (take_date(text, year, month, day)) {
    const std::chrono::year_month_day ymd(std::chrono::year(year),
                                          std::chrono::month(static_cast<unsigned>(month)),
                                          std::chrono::day(static_cast<unsigned>(day)));
    if (!ymd.ok()) return false;
    date = static_cast<double>(std::chrono::sys_days(ymd).time_since_epoch().count()) * 86400.0;
  }
  double clock = 0.0;
  double ahead = 0.0;
  if (!take_clock(text, clock) || !is_zone(text, ahead)) return false;
  seconds = date + clock - ahead;
  return true;
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
    if (text.find('.') != std::string_view::npos) {
      return is_stamp(text, number) ? CellContent::kNumber : CellContent::kText;
    }
    std::ranges::replace_copy(text, point.begin(), decimal, '.');
    text = {point.data(), text.size()};
  }
  const bool read =
      is_whole_number(text, number) || is_stamp(text, number) || is_fortran_number(text, number);
  return read ? CellContent::kNumber : CellContent::kText;
}

bool is_comment(std::string_view line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

std::string in_quotes(std::string_view text) {
  std::size_t end = std::min(text.size(), kQuotedBytes);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
    --end;  // not within a character
  }
  return "'" + std::string(text.substr(0, end)) + (end == text.size() ? "'" : "...'");
}

}  // namespace stillhand::measurement
