// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/known_quantity.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <sstream>

#include "services/core/contract/config_error.hpp"

namespace stillhand::calibrate {
namespace {

using device_rig::CalibratedSignal;

constexpr double kDegree_rad = std::numbers::pi / 180.0;

/// Another unit of a signal, in the signal's own.
struct OtherUnit {
  const char* name;
  double factor;
};

constexpr std::array<OtherUnit, device_rig::kCalibratedSignals.size()> kOtherUnits{
    {{"kg", kGravity_m_s2}, {"g", kGravity_m_s2}, {"deg", kDegree_rad}}};

double known_quantity(const std::string& word, CalibratedSignal signal) {
  char* end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' '));
  const OtherUnit other = kOtherUnits[index_of(signal)];
  const char* own = device_rig::words_of(signal).unit;
  const bool is_number = end != word.c_str() && std::isfinite(number);
  if (is_number && (unit.empty() || unit == own)) return number;
  if (is_number && unit == other.name) return number * other.factor;
  throw ConfigError("--known", word,
                    fmt::format("a number with {}, {} or no unit", own, other.name));
}

}  // namespace

std::vector<double> known_quantities(const std::string& words, CalibratedSignal signal) {
  std::vector<double> known;
  std::istringstream list(words);
  for (std::string word; std::getline(list, word, ',');) {
    known.push_back(known_quantity(word, signal));
    constexpr double kMost_m_s2 = 1.001 * kGravity_m_s2;
    if (signal == CalibratedSignal::kAcceleration && std::abs(known.back()) > kMost_m_s2) {
      throw ConfigError("--known", word, "at most 1g: the steps turn the sensor in gravity");
    }
  }
  return known;
}

std::string instruction(CalibratedSignal signal, double known) {
  const char* side = known < 0.0 ? "left" : "right";
  const double size = std::abs(known);
  switch (signal) {
    case CalibratedSignal::kForce:
      if (known == 0.0) return "Take every hand and weight off the stick.";
      return fmt::format(
          "Pull the grip to the {} with {:.4g} N ({:.4g} kg on a cord over a pulley).", side, size,
          size / kGravity_m_s2);
    case CalibratedSignal::kAcceleration: {
      if (known == 0.0) return "Lay the accelerometer level.";
      const double tilt_deg = std::asin(std::min(1.0, size / kGravity_m_s2)) / kDegree_rad;
      return fmt::format("Turn the accelerometer by {:.3g} degrees, so that its {} side is up.",
                         tilt_deg, side);
    }
    case CalibratedSignal::kAngle:
      break;
  }
  if (known == 0.0) return "Hold the stick upright.";
  return fmt::format("Hold the stick {:.4g} degrees to the {}.", size / kDegree_rad, side);
}

}  // namespace stillhand::calibrate
