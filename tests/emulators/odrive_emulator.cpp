// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/odrive_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace stillhand::emulators {
namespace {

constexpr int kWatchdogExpired = 1 << 11;
constexpr int kInvalidState = 1;
constexpr int kNoResponse = 4;             // of the encoder
constexpr int kUnknownPhase = 1 << 28;     // of the motor
constexpr std::size_t kReplyBuffer = 512;  // BufferedStreamSink<512>
constexpr std::size_t kProperty = 9;       // char response[10]

const std::map<std::string, std::string>& as_shipped() {
  static const std::map<std::string, std::string> kStored{
      {"fw_version_major", "0"},
      {"fw_version_minor", "5"},
      {"fw_version_revision", "6"},
      {"vbus_voltage", "24.087744"},
      {"axis0.motor.is_calibrated", "1"},
      {"axis0.encoder.is_ready", "1"},
      {"axis0.config.enable_watchdog", "1"},
      {"axis0.config.watchdog_timeout", "0.100000"},
      {"axis0.motor.config.current_lim", "10.000000"},
      {"axis0.motor.config.torque_lim", "2.500000"},
      {"axis0.motor.config.torque_constant", "0.250000"},
      {"axis0.controller.config.input_mode", "1"},
      {"axis0.controller.config.enable_torque_mode_vel_limit", "0"},
      {"axis0.controller.config.vel_limit", "2.000000"},
      {"axis0.controller.config.vel_gain", "0.166667"},
      {"axis0.controller.config.pos_gain", "20.000000"},
      {"axis0.config.enable_sensorless_mode", "0"},
      {"axis0.config.startup_closed_loop_control", "0"},
      {"axis0.config.startup_motor_calibration", "0"},
      {"axis0.config.startup_encoder_index_search", "0"},
      {"axis0.config.startup_encoder_offset_calibration", "0"},
      {"axis0.config.startup_homing", "0"}};
  return kStored;
}

unsigned sum_of(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  return sum;
}

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(' ', at)) != std::string::npos;) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::string six_decimals(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%f", value);
  return text;
}

}  // namespace

OdriveEmulator::OdriveEmulator() : settings_(as_shipped()) {}

double OdriveEmulator::setting(const char* name) const {
  return std::strtod(settings_.at(name).c_str(), nullptr);
}

void OdriveEmulator::reboot(std::int64_t now_ns) {
  settings_ = as_shipped();
  line_.clear();
  disarm();
  axis_error_ = motor_error_ = encoder_error_ = 0;
  control_mode_ = 3;
  input_torque_ = 0.0;
  test_property_ = "0";
  begin(now_ns);
}

void OdriveEmulator::fault(int code) {
  axis_error_ |= code;
  disarm();
}

void OdriveEmulator::lose_position(bool lost) {
  lost_ = lost;
  if (!lost) return;
  encoder_error_ |= kNoResponse;
  if (state_ != kClosedLoop) return;
  motor_error_ |= kUnknownPhase;
  disarm();
}

void OdriveEmulator::disarm() {
  state_ = kIdle;
  torque_n_m_ = 0.0;
}

// '!' ends a line, too.
std::string OdriveEmulator::take(std::string_view bytes, std::int64_t now_ns) {
  std::string answers;
  for (const char c : bytes) {
    if (c != '\n' && c != '\r' && c != '!') {
      line_ += c;
      continue;
    }
    if (!line_.empty()) answers += answer(std::move(line_), now_ns);
    line_.clear();
  }
  // What the buffer of the drive does not hold is cut.
  return answers.substr(0, kReplyBuffer);
}

std::string OdriveEmulator::answer(std::string line, std::int64_t now_ns) {
  line.resize(std::min(line.find(';'), line.size()));
  const std::size_t star = line.find('*');
  const bool checked = star != std::string::npos;
  if (checked) {
    // A wrong checksum: no answer at all.
    if (std::strtoul(line.c_str() + star + 1, nullptr, 10) != sum_of(line.substr(0, star)))
      return "";
    line.resize(star);
  }
  std::string answers;
  const std::string text = execute(line, now_ns);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string each = text.substr(at, end - at);
    if (checked) each += "*" + std::to_string(sum_of(each));
    answers += each + "\r\n";
    at = end + 1;
  }
  return answers;
}

std::string OdriveEmulator::execute(const std::string& line, std::int64_t now_ns) {
  const std::vector<std::string> words = words_of(line);
  if (words.empty()) return "unknown command";
  const std::string& verb = words[0];
  if (verb == "i") {
    char number[16];
    std::snprintf(number, sizeof(number), "2071%08X", serial_);
    return "Hardware version: 3.6-56V\nFirmware version: 0.5.6\nSerial number: " +
           std::string(number);
  }
  if (verb == "sc") {
    axis_error_ = motor_error_ = encoder_error_ = 0;
    if (lost_) encoder_error_ = kNoResponse;
    return "";
  }
  if (verb == "sr") return reboot(now_ns), "";
  if (words.size() < 2) return "invalid command format";
  if (verb == "r") return value_of(words[1], now_ns);
  if (verb == "w") {
    if (words.size() < 3) return "invalid command format";
    write(words[1], words[2], now_ns);
    return "";
  }
  if (words[1] != "0") return "invalid motor " + words[1];
  if (verb == "f") {
    ++record_.queries;
    // A position that is not known reads as 0.
    return lost_ ? "0.000000 0.000000"
                 : six_decimals(senses_.position_rev) + " " + six_decimals(senses_.velocity_rev_s);
  }
  if (verb == "c" && words.size() > 2) {
    command(std::strtod(words[2].c_str(), nullptr), now_ns);
    return "";
  }
  if (verb == "u" || verb == "p" || verb == "q" || verb == "v" || verb == "t") {
    ++record_.other_modes;
    fed_ns_ = now_ns;
    if (verb != "u") control_mode_ = verb == "v" ? 2 : 3;
    return "";
  }
  return "unknown command";
}

void OdriveEmulator::command(double torque_n_m, std::int64_t now_ns) {
  control_mode_ = 1;
  input_torque_ = torque_n_m;
  fed_ns_ = command_ns_ = now_ns;
  if (state_ == kClosedLoop) {
    ++record_.commands;
    if (setting("axis0.config.enable_watchdog") == 0.0) ++record_.without_watchdog;
    if (std::isinf(setting("axis0.motor.config.torque_lim"))) ++record_.without_bound;
  }
  move(now_ns);
}

void OdriveEmulator::write(const std::string& name, const std::string& value, std::int64_t now_ns) {
  if (name == "axis0.requested_state") {
    return request(static_cast<int>(std::strtol(value.c_str(), nullptr, 10)), now_ns);
  }
  if (name == "test_property") {
    test_property_ = value;
  } else if (const auto known = settings_.find(name); known != settings_.end()) {
    known->second = value;
  }
}

void OdriveEmulator::request(int state, std::int64_t now_ns) {
  if (state == kIdle) {
    ++record_.stops;
    return disarm();
  }
  if (state != kClosedLoop) {
    ++record_.other_modes;
    return;
  }
  if (setting("axis0.motor.is_calibrated") == 0.0 || setting("axis0.encoder.is_ready") == 0.0) {
    axis_error_ |= kInvalidState;
    return;
  }
  if (lost_) {
    motor_error_ |= kUnknownPhase;
    return;
  }
  axis_error_ &= ~kInvalidState;
  fed_ns_ = command_ns_ = now_ns;
  state_ = kClosedLoop;
  hold_rev_ = senses_.position_rev;
  ++record_.commands;
  if (control_mode_ != 1) ++record_.with_gains;
  // A torque of before acts at once.
  record_.first_torque_n_m = std::max(record_.first_torque_n_m, std::abs(input_torque_));
  move(now_ns);
}

std::string OdriveEmulator::value_of(const std::string& name, std::int64_t now_ns) const {
  const auto cut = [](const std::string& text) { return text.substr(0, kProperty); };
  if (name == "axis0.current_state") return std::to_string(state_);
  if (name == "axis0.error") return cut(std::to_string(axis_error_));
  if (name == "axis0.motor.error") return cut(std::to_string(motor_error_));
  if (name == "axis0.encoder.error") return cut(std::to_string(encoder_error_));
  if (name == "axis0.controller.error") return forgets_ ? "invalid property" : "0";
  if (name == "axis0.motor.current_control.Iq_measured") {
    return cut(six_decimals(torque_n_m_ / setting("axis0.motor.config.torque_constant")));
  }
  if (name == "system_stats.uptime") return cut(std::to_string((now_ns - began_ns_) / 1'000'000));
  if (name == "test_property") return cut(test_property_);
  const auto known = settings_.find(name);
  return known == settings_.end() ? "invalid property" : cut(known->second);
}

void OdriveEmulator::move(std::int64_t now_ns) {
  double wanted_n_m = 0.0;
  if (state_ == kClosedLoop) {
    const double velocity = senses_.velocity_rev_s;
    const double limit = setting("axis0.controller.config.vel_limit");
    const double gain = setting("axis0.controller.config.vel_gain");
    wanted_n_m = input_torque_;
    if (control_mode_ != 1) {
      const double hold = setting("axis0.controller.config.pos_gain");
      wanted_n_m += gain * (hold * (hold_rev_ - senses_.position_rev) - velocity);
    } else if (setting("axis0.controller.config.enable_torque_mode_vel_limit") != 0.0) {
      wanted_n_m = std::clamp(wanted_n_m, (-limit - velocity) * gain, (limit - velocity) * gain);
    }
    const double most = std::min(
        setting("axis0.motor.config.torque_lim"),
        setting("axis0.motor.config.current_lim") * setting("axis0.motor.config.torque_constant"));
    wanted_n_m = std::clamp(wanted_n_m, -most, most);
  }
  torque_n_m_ = wanted_n_m;
  record_.most_torque_n_m = std::max(record_.most_torque_n_m, std::abs(torque_n_m_));
  if (torque_n_m_ != 0.0) {
    record_.torque_after_ms =
        std::max(record_.torque_after_ms, 1e-6 * static_cast<double>(now_ns - command_ns_));
  }
}

// The watchdog counts in every state; nothing feeds that of an idle axis.
void OdriveEmulator::tick(std::int64_t now_ns) {
  const double silent_s = 1e-9 * static_cast<double>(now_ns - fed_ns_);
  if (setting("axis0.config.enable_watchdog") != 0.0 &&
      silent_s > setting("axis0.config.watchdog_timeout")) {
    axis_error_ |= kWatchdogExpired;
    if (state_ == kClosedLoop) {
      ++record_.timeouts;
      disarm();
    }
  }
  move(now_ns);
}

}  // namespace stillhand::emulators
