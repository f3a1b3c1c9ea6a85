// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/csv.hpp"
#include "services/files/settings/section.hpp"

namespace stillhand::measurement {
namespace {

constexpr const char* kForm =
    "'TITLE=NAME [UNIT]', for example 'acc=a_y [m/s^2]' or "
    "'ai0=f [V] * 22.5 [N/V]'";

bool is_space(char c) { return c == ' ' || c == '\t'; }

std::string_view without_spaces(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

// "[unit]" in front of a text, which is shortened by it; false: a bracket without its end.
bool take_unit(std::string_view& text, std::string& unit) {
  if (!text.starts_with('[')) return true;
  const std::size_t close = text.find(']');
  if (close == std::string_view::npos) return false;
  unit = without_spaces(text.substr(1, close - 1));
  text = without_spaces(text.substr(close + 1));
  return !unit.empty();
}

bool take_gain(std::string_view text, Gain& gain) {
  if (text.empty()) return true;
  if (text.front() != '*' && text.front() != '/') return false;
  gain.divides = text.front() == '/';
  text = without_spaces(text.substr(1));
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), gain.number);
  if (error != std::errc() || !std::isfinite(gain.number) || gain.number == 0.0) return false;
  text = without_spaces(text.substr(static_cast<std::size_t>(end - text.data())));
  return take_unit(text, gain.unit) && text.empty();
}

// What stands behind the '='.
std::optional<ColumnWish> channel_of(std::string_view text) {
  text = without_spaces(text);
  const std::size_t end = std::min(text.find_first_of("[*/ \t"), text.size());
  ColumnWish wish;
  wish.name = text.substr(0, end);
  if (wish.name.empty() || wish.name.find_first_of(",=]\"'") != std::string::npos) {
    return std::nullopt;
  }
  text = without_spaces(text.substr(end));
  if (!take_unit(text, wish.unit) || !take_gain(text, wish.gain)) return std::nullopt;
  // A, not a: the name of a channel that has a fixed unit counts in either case.
  std::string lower = wish.name;
  std::ranges::transform(lower, lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (!si_unit(lower).empty()) wish.name = lower;
  return wish;
}

// A text in single quotes of YAML.
std::string yaml_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::string si_unit(const std::string& name) {
  if (name == "f_motor") return "N";
  return std::string(recording::known_unit(name));
}

ColumnWish parse_wish(const std::string& text, const std::string& place) {
  // YAML folds the line breaks of a text: such a title would be another one when it is read again.
  constexpr auto is_control = [](char c) { return (c >= 0 && c < ' ' && c != '\t') || c == 0x7f; };
  if (std::ranges::any_of(text, is_control)) {
    throw ConfigError(place, "'" + text + "'",
                      "a title in one line; a column without one has a number: '#2=f [N]'");
  }
  for (std::size_t at = text.rfind('='); at != std::string::npos && at > 0;
       at = text.rfind('=', at - 1)) {
    std::optional<ColumnWish> wish = channel_of(std::string_view(text).substr(at + 1));
    if (!wish) continue;
    wish->from = without_spaces(std::string_view(text).substr(0, at));
    if (!wish->from.empty()) return *wish;
  }
  throw ConfigError(place, "'" + text + "'", kForm);
}

std::string wish_text(const ColumnWish& wish) {
  std::string text = wish.from + "=" + wish.name;
  if (!wish.unit.empty()) text += " [" + wish.unit + "]";
  if (wish.gain.number != 1.0 || !wish.gain.unit.empty()) {
    text += fmt::format(" {} {}", wish.gain.divides ? '/' : '*', wish.gain.number);
    if (!wish.gain.unit.empty()) text += " [" + wish.gain.unit + "]";
  }
  return text;
}

char parse_separator(const std::string& text, const std::string& place) {
  constexpr std::array<std::pair<std::string_view, char>, 9> kWords{{{",", ','},
                                                                     {"comma", ','},
                                                                     {";", ';'},
                                                                     {"semicolon", ';'},
                                                                     {"\t", '\t'},
                                                                     {"\\t", '\t'},
                                                                     {"tab", '\t'},
                                                                     {" ", ' '},
                                                                     {"blank", ' '}}};
  for (const auto& [word, sign] : kWords) {
    if (text == word) return sign;
  }
  throw ConfigError(place, "'" + text + "'", "comma, semicolon, tab or blank");
}

char parse_decimal(const std::string& text, const std::string& place) {
  if (text == "." || text == "point") return '.';
  if (text == "," || text == "comma") return ',';
  throw ConfigError(place, "'" + text + "'", "point or comma");
}

double check_rate_hz(double rate_hz, const std::string& place) {
  if (std::isnormal(rate_hz) && rate_hz > 0.0 && rate_hz <= 1e9) return rate_hz;
  throw ConfigError(place, fmt::format("{}", rate_hz), "a rate in Hz, for example 1000");
}

namespace {

Mapping mapping_of(const settings::Entry& top) {
  settings::SectionReader reader(top, "mapping");
  Mapping out;
  if (const settings::Entry* map = reader.find("map")) {
    if (map->kind != settings::Entry::Kind::kSequence) {
      throw ConfigError(map->place + ": mapping.map", settings::got_of(*map),
                        std::string("a list of ") + kForm);
    }
    for (const settings::Entry& entry : map->children) {
      if (entry.kind != settings::Entry::Kind::kScalar) {
        throw ConfigError(entry.place + ": mapping.map", settings::got_of(entry), kForm);
      }
      out.columns.push_back(parse_wish(entry.text, entry.place + ": mapping.map"));
    }
  }
  if (const settings::Entry* rate = reader.find("rate_hz")) {
    double rate_hz = 0.0;
    reader("rate_hz", rate_hz, Range{0.0, 1e9}, "sample rate");
    out.rate_hz = check_rate_hz(rate_hz, rate->place + ": mapping.rate_hz");
  }
  if (const settings::Entry* sign = reader.find("separator")) {
    out.form.separator = parse_separator(sign->text, sign->place + ": mapping.separator");
  }
  if (const settings::Entry* sign = reader.find("decimal")) {
    out.form.decimal = parse_decimal(sign->text, sign->place + ": mapping.decimal");
  }
  reader.refuse_unknown();
  return out;
}

}  // namespace

Mapping parse_mapping(const std::string& yaml, const std::string& origin) {
  return mapping_of(settings::parse_text(yaml, origin));
}

Mapping read_mapping(const std::string& path) { return mapping_of(settings::parse_file(path)); }

std::string mapping_yaml(const Mapping& mapping, const std::string& recording) {
  std::string text = "# Columns of " + in_one_line(recording) + ", for --map-file.\n";
  if (!mapping.columns.empty()) text += "map:\n";
  for (const ColumnWish& wish : mapping.columns) {
    text += "  - " + yaml_text(wish_text(wish)) + "\n";
  }
  if (mapping.rate_hz) text += fmt::format("rate_hz: {}\n", *mapping.rate_hz);
  const auto sign = [](char c) {
    return c == ' ' ? "blank" : c == '\t' ? "tab" : c == ';' ? "semicolon" : "comma";
  };
  if (mapping.form.separator != 0) {
    text += fmt::format("separator: {}\n", sign(mapping.form.separator));
  }
  if (mapping.form.decimal != 0) {
    text += fmt::format("decimal: {}\n", mapping.form.decimal == ',' ? "comma" : "point");
  }
  return text;
}

}  // namespace stillhand::measurement
