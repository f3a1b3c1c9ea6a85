// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/moteus_settings.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

namespace stillhand::device_rig::moteus {
namespace {

// The longest time that a command without a watchdog of its own may count.
constexpr double kMostTimeout_s = 0.1;
constexpr std::size_t kMostAnswer = 4096;

/// The console prints "nan", "inf", plain decimals, and booleans as 0 and 1.
std::optional<double> decimal(std::string_view text) noexcept {
  if (text == "nan" || text == "-nan") return std::numeric_limits<double>::quiet_NaN();
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string text_of(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

SettingFault fault(std::string_view name, std::string_view got, const std::string& want,
                   const std::string& value) {
  return {std::string(name), std::string(got), want,
          "conf set " + std::string(name) + " " + value + ", then conf write"};
}

}  // namespace

std::optional<SettingFault> judge_setting(std::string_view name, std::string_view text,
                                          const SettingLimits& limits) {
  const auto value = decimal(text);
  if (name == "servo.timeout_mode" && value != 0.0) {
    return fault(name, text, "0: the driver is off after a timeout", "0");
  }
  if (name == "servo.default_timeout_s" && !(value && *value > 0.0 && *value <= kMostTimeout_s)) {
    return fault(name, text, "more than 0 and at most 0.1 s", "0.1");
  }
  if (name == "servo.max_current_A" && !(value && *value > 0.0 && *value <= limits.max_current_a)) {
    const std::string most = text_of(limits.max_current_a);
    return fault(name, text, "at most " + most + " A (drive.max_current_a)", most);
  }
  if (name == "servo.fixed_voltage_mode" && value != 0.0) {
    return fault(name, text, "0: with it the drive's limits do not act", "0");
  }
  const bool lower = name == "servopos.position_min";
  if (lower || name == "servopos.position_max") {
    const double room_rev = value ? (lower ? -*value : *value) : 0.0;
    if (!value || (!std::isnan(*value) && room_rev < limits.travel_rev)) {
      const std::string end = (lower ? "-" : "") + text_of(limits.travel_rev);
      return fault(name, text, "nan, or outside of the stick's travel: " + end + " rev", "nan");
    }
  }
  return std::nullopt;
}

Frame ask_setting(std::string_view name) noexcept {
  std::array<char, Frame::kMost> text{};
  std::size_t size = 0;
  for (const std::string_view part :
       {std::string_view("conf get "), name, std::string_view("\n")}) {
    for (const char c : part) {
      if (size < text.size()) text[size++] = c;
    }
  }
  Frame frame;
  FrameWriter writer(frame);
  writer.to_console({text.data(), size});
  writer.pad();
  return frame;
}

Frame poll_setting() noexcept {
  constexpr std::uint32_t kMost = 48;
  Frame frame;
  FrameWriter writer(frame);
  writer.poll_console(kMost);
  return frame;
}

void ConsoleAnswer::take(std::span<const std::uint8_t> text) {
  for (const std::uint8_t each : text) {
    if (text_.size() < kMostAnswer) text_ += static_cast<char>(each);
  }
}

std::optional<std::string> ConsoleAnswer::line() const {
  const std::size_t end = text_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  const std::size_t last = text_.find_last_not_of("\r\n", end);
  return last == std::string::npos ? std::string() : text_.substr(0, last + 1);
}

}  // namespace stillhand::device_rig::moteus
