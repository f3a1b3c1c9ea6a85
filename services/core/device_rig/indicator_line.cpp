// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/indicator_line.hpp"

#include <array>
#include <charconv>
#include <cstddef>
#include <limits>

namespace stillhand::device_rig {
namespace {

constexpr std::size_t kFields = 4;
// Standard gravity, and the avoirdupois pound in kg: both exact by definition.
constexpr double kGravity_m_s2 = 9.80665;
constexpr double kPound_kg = 0.45359237;

std::optional<std::array<std::string_view, kFields>> fields_of(std::string_view line) noexcept {
  std::array<std::string_view, kFields> fields{};
  for (std::size_t i = 0; i + 1 < kFields; ++i) {
    const std::size_t comma = line.find(',');
    if (comma == std::string_view::npos) return std::nullopt;
    fields[i] = line.substr(0, comma);
    line.remove_prefix(comma + 1);
  }
  fields.back() = line;
  return fields;
}

// A sign and as many characters as each line has: a number that lost one is none.
std::optional<double> number_of(std::string_view text) noexcept {
  constexpr std::size_t kCharacters = 9;
  constexpr std::size_t kPoint = 5;
  if (text.size() != kCharacters || (text[0] != '+' && text[0] != '-')) return std::nullopt;
  for (std::size_t i = 1; i < kCharacters; ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (i == kPoint ? text[i] != '.' : !digit) return std::nullopt;
  }
  double value = 0.0;
  std::from_chars(text.data() + 1, text.data() + text.size(), value);
  return text[0] == '-' ? -value : value;
}

std::optional<double> newtons_of(std::string_view unit) noexcept {
  if (unit == "N") return 1.0;
  if (unit == "g") return 1e-3 * kGravity_m_s2;
  if (unit == "kg") return kGravity_m_s2;
  if (unit == "lb") return kPound_kg * kGravity_m_s2;
  return std::nullopt;
}

}  // namespace

std::optional<double> indicator_force_n(std::string_view line) noexcept {
  const auto fields = fields_of(line);
  if (!fields) return std::nullopt;
  const auto& [weight, number, unit, state] = *fields;
  if (weight != "N" && weight != "G") return std::nullopt;
  const auto value = number_of(number);
  const auto newtons = newtons_of(unit);
  if (!value || !newtons) return std::nullopt;
  if (state == "OL") return std::numeric_limits<double>::quiet_NaN();
  // Unstable is the rule under a hand.
  if (state != "ST" && state != "US") return std::nullopt;
  return *value * *newtons;
}

}  // namespace stillhand::device_rig
