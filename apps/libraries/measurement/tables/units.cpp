// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/units.hpp"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

// Longer than any unit; the parser of the library is spared everything else.
constexpr std::size_t kLongestUnit = 40;

struct UnitFree {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, UnitFree>;

struct ConverterFree {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};

using Alias = std::pair<std::string_view, std::string_view>;
// Written everywhere, and not in the library's table.
constexpr std::array<Alias, 6> kAliases{{{"deg", "degree"},
                                         {"Nm", "N.m"},
                                         {"mNm", "mN.m"},
                                         {"kNm", "kN.m"},
                                         {"msec", "ms"},
                                         {"usec", "us"}}};
// Written too, and not in its grammar.
constexpr std::array<Alias, 4> kSigns{
    {{"\u207B\u00B9", "-1"}, {"\u207B\u00B2", "-2"}, {"\u207B\u00B3", "-3"}, {"\u22C5", "."}}};
// The library's g is the gram.
constexpr std::array<Alias, 4> kGravity{
    {{"g", "gravity"}, {"G", "gravity"}, {"mg", "(0.001 gravity)"}, {"gn", "gravity"}}};

// Made once and kept: the table has a thousand units.
const ut_system* unit_system() {
  static const ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    return ut_read_xml(nullptr);
  }();
  if (system == nullptr) {
    throw ConfigError("units", "no table of units (udunits2.xml) on this machine",
                      "the package libudunits2-data");
  }
  return system;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

template <std::size_t count>
std::string with_aliases(std::string_view text, const std::array<Alias, count>& aliases) {
  std::string out;
  while (!text.empty()) {
    std::size_t length = 0;
    while (length < text.size() && is_letter(text[length])) ++length;
    std::string_view word = text.substr(0, std::max<std::size_t>(length, 1));
    text.remove_prefix(word.size());
    for (const Alias& alias : aliases) {
      if (word == alias.first) {
        word = alias.second;
        break;
      }
    }
    out += word;
  }
  return out;
}

bool is_one(std::string_view text) { return text.empty() || text == "-" || text == "1"; }

Unit parsed(const std::string& text, bool with_gravity) {
  if (text.size() > kLongestUnit) return nullptr;
  if (is_one(text)) return Unit(ut_get_dimensionless_unit_one(unit_system()));
  std::string words = with_aliases(text, kAliases);
  for (const auto& [sign, plain] : kSigns) {
    for (std::size_t at = words.find(sign); at != std::string::npos; at = words.find(sign)) {
      words.replace(at, sign.size(), plain);
    }
  }
  if (with_gravity) words = with_aliases(words, kGravity);
  return Unit(ut_parse(unit_system(), words.c_str(), UT_UTF8));
}

// Nothing where the way is no straight line: a frequency for a period, a level in decibels.
std::optional<UnitConversion> between(ut_unit* from, ut_unit* to) {
  const std::unique_ptr<cv_converter, ConverterFree> converter(ut_get_converter(from, to));
  if (converter == nullptr) return std::nullopt;
  constexpr double kRounding = 1e-15;  // a few roundings of a double
  const auto close = [](double a, double b) { return std::abs(a - b) <= kRounding * std::abs(b); };
  UnitConversion out;
  out.offset = cv_convert_double(converter.get(), 0.0);
  out.scale = cv_convert_double(converter.get(), 1.0) - out.offset;
  const double third = cv_convert_double(converter.get(), 3.0) - out.offset;
  constexpr double kLine = 1e-9;  // beyond the rounding of a large offset
  if (!std::isfinite(out.offset) || !std::isnormal(out.scale) ||
      !(std::abs(third - 3.0 * out.scale) <= kLine * std::abs(third))) {
    return std::nullopt;
  }
  const double inverse = std::round(1.0 / out.scale);
  if (inverse > 1.0 && close(1.0 / out.scale, inverse)) {
    out.scale = 1.0;
    out.parts = inverse;
  }
  return out;
}

std::optional<UnitConversion> converted(const std::string& from, const Gain& gain,
                                        const std::string& to, bool with_gravity) {
  Unit source = parsed(from, with_gravity);
  const Unit target = parsed(to, with_gravity);
  if (source == nullptr || target == nullptr) return std::nullopt;
  if (!gain.unit.empty()) {
    const Unit per = parsed(gain.unit, with_gravity);
    if (per == nullptr) return std::nullopt;
    source.reset(gain.divides ? ut_divide(source.get(), per.get())
                              : ut_multiply(source.get(), per.get()));
  }
  if (source == nullptr || ut_are_convertible(source.get(), target.get()) == 0) return std::nullopt;
  return between(source.get(), target.get());
}

}  // namespace

bool UnitConversion::is_identity() const noexcept {
  return factor == 1.0 && divisor == 1.0 && scale == 1.0 && parts == 1.0 && offset == 0.0;
}

void UnitConversion::apply(std::vector<double>& values) const noexcept {
  if (is_identity()) return;
  for (double& value : values) value = ((value * factor / divisor) * scale / parts) + offset;
}

std::optional<UnitConversion> unit_conversion(const std::string& from, const Gain& gain,
                                              const std::string& to) {
  std::optional<UnitConversion> out;
  if (gain.unit.empty() && (from == to || (is_one(from) && is_one(to)))) {
    out.emplace();
  } else {
    out = converted(from, gain, to, false);
    if (!out) out = converted(from, gain, to, true);
  }
  if (out) (gain.divides ? out->divisor : out->factor) = gain.number;
  return out;
}

bool is_unit(const std::string& text) {
  return !is_one(text) && (parsed(text, false) != nullptr || parsed(text, true) != nullptr);
}

}  // namespace stillhand::measurement
