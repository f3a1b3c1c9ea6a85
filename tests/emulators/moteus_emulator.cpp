// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/moteus_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>

namespace stillhand::emulators {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// Gains that a drive is shipped with, of the order of the maker's.
constexpr double kKp = 4.0;   // [N m/rev]
constexpr double kKd = 0.05;  // [N m s/rev]
constexpr double kTimeoutKd = 0.5;

std::uint8_t crc(std::string_view text) {
  unsigned value = 0;
  for (const char c : text) {
    for (unsigned bit = 0x80; bit != 0; bit >>= 1) {
      const bool high = ((value & 0x80) != 0) != ((static_cast<unsigned char>(c) & bit) != 0);
      value = (value << 1 ^ (high ? 0x97u : 0u)) & 0xffu;
    }
  }
  return static_cast<std::uint8_t>(value);
}

/// Scale of a register for int8, int16, int32, from the tables of registers.md.
double scale(std::uint32_t address, unsigned kind) {
  const auto pick = [kind](double a, double b, double c) {
    return kind == 0 ? a : kind == 1 ? b : c;
  };
  if (kind == 3) return 1.0;
  if (address == 0x01 || address == 0x20) return pick(0.01, 0.0001, 0.00001);
  if (address == 0x02 || address == 0x21) return pick(0.1, 0.00025, 0.00001);
  if (address == 0x03 || address == 0x22 || address == 0x25) return pick(0.5, 0.01, 0.001);
  if (address == 0x0d) return pick(0.5, 0.1, 0.001);
  if (address == 0x0e) return pick(1.0, 0.1, 0.001);
  if (address == 0x27) return pick(0.01, 0.001, 0.000001);
  const bool pwm =
      address == 0x23 || address == 0x24 || address == 0x2b || (address >= 0x60 && address <= 0x6c);
  if (pwm) return pick(1.0 / 127, 1.0 / 32767, 1.0 / 2147483647);
  return 1.0;
}

const std::map<std::string, std::string>& memory() {
  static const std::map<std::string, std::string> kStored{
      {"servo.timeout_mode", "0"},
      {"servo.default_timeout_s", "0.100000"},
      {"servo.max_current_A", "10.000000"},
      {"servo.fixed_voltage_mode", "0"},
      {"servopos.position_min", "nan"},
      {"servopos.position_max", "nan"},
      {"servo.timeout_max_torque_Nm", "5.000000"}};
  return kStored;
}

/// Reads and writes the bytes of a payload.
class Bytes {
 public:
  explicit Bytes(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}
  [[nodiscard]] bool more() const { return at_ < bytes_.size(); }
  unsigned next() { return more() ? bytes_[at_++] : 0u; }
  std::uint32_t varuint() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const unsigned each = next();
      value |= (each & 0x7fu) << shift;
      if (each < 0x80) break;
    }
    return value;
  }
  double number(std::uint32_t address, unsigned kind) {
    const unsigned size = kind == 0 ? 1 : kind == 1 ? 2 : 4;
    std::uint32_t bits = 0;
    for (unsigned i = 0; i < size; ++i) bits |= next() << (8 * i);
    if (kind == 3) {
      float real = 0;
      std::memcpy(&real, &bits, sizeof(real));
      return real;
    }
    const auto whole = size == 1   ? static_cast<std::int32_t>(static_cast<std::int8_t>(bits))
                       : size == 2 ? static_cast<std::int32_t>(static_cast<std::int16_t>(bits))
                                   : static_cast<std::int32_t>(bits);
    const std::int64_t lowest = -(std::int64_t{1} << (8 * size - 1));
    if (whole == lowest && scale(address, 0) != 1.0) return kNaN;
    return whole * scale(address, kind);
  }
  std::string text(std::uint32_t size) {
    std::string taken;
    for (std::uint32_t i = 0; i < size && more(); ++i) taken += static_cast<char>(next());
    return taken;
  }

 private:
  const std::vector<std::uint8_t>& bytes_;
  std::size_t at_ = 0;
};

void put_varuint(std::vector<std::uint8_t>& reply, std::uint32_t value) {
  for (; value >= 0x80; value >>= 7) reply.push_back((value & 0x7fu) | 0x80u);
  reply.push_back(static_cast<std::uint8_t>(value));
}

void put(std::vector<std::uint8_t>& reply, std::uint32_t address, unsigned kind, double value) {
  std::uint32_t bits = 0;
  const unsigned size = kind == 0 ? 1 : kind == 1 ? 2 : 4;
  if (kind == 3) {
    const auto real = static_cast<float>(value);
    std::memcpy(&bits, &real, sizeof(bits));
  } else if (std::isnan(value)) {
    bits = 1u << (8 * size - 1);
  } else {
    const double most = std::exp2(8 * size - 1) - 1;
    // The counter wraps; everything else stays within its type.
    const double count = value / scale(address, kind);
    bits = address == 0x70
               ? static_cast<std::uint32_t>(static_cast<std::int64_t>(count))
               : static_cast<std::uint32_t>(std::lround(std::clamp(count, -most, most)));
  }
  for (unsigned i = 0; i < size; ++i) reply.push_back((bits >> (8 * i)) & 0xffu);
}

}  // namespace

/// Registers that one frame writes, with the defaults of registers.md.
struct MoteusEmulator::Command {
  std::optional<int> mode;
  double position = 0.0, torque = 0.0, kp = 1.0, kd = 1.0, ilimit = 1.0;
  double most = kNaN, timeout = 0.0;

  void write(std::uint32_t address, double value) {
    if (address == 0x00) mode = static_cast<int>(value);
    if (address == 0x20) position = value;
    if (address == 0x22) torque = value;
    if (address == 0x23) kp = value;
    if (address == 0x24) kd = value;
    if (address == 0x25) most = value;
    if (address == 0x27) timeout = value;
    if (address == 0x2b) ilimit = value;
  }
};

MoteusEmulator::MoteusEmulator(bool uart) : uart_(uart), settings_(memory()) {}

double MoteusEmulator::setting(const char* name) const {
  return std::strtod(settings_.at(name).c_str(), nullptr);
}

void MoteusEmulator::reboot(std::int64_t now_ns) {
  settings_ = memory();
  console_in_.clear();
  console_out_.clear();
  mode_ = fault_ = 0;
  torque_n_m_ = 0.0;
  began_ns_ = now_ns;
  checked_ = false;
}

void MoteusEmulator::fault(int code) {
  mode_ = 1;
  fault_ = code;
  torque_n_m_ = 0.0;
}

std::string MoteusEmulator::take(std::string_view bytes, std::int64_t now_ns) {
  std::string answers;
  for (const char c : bytes) {
    if (c != '\n' && c != '\r') {
      line_ += c;
      continue;
    }
    if (!line_.empty()) answers += answer(std::move(line_), now_ns);
    line_.clear();
  }
  return answers;
}

std::string MoteusEmulator::answer(std::string line, std::int64_t now_ns) {
  const auto ended = [this](std::string text) {
    if (uart_) {
      text += ' ';
      char digits[8];
      std::snprintf(digits, sizeof(digits), "*%02X", crc(text));
      text += digits;
    }
    return text + "\r\n";
  };
  const std::size_t star = line.find('*');
  if (star != std::string::npos) {
    if (std::strtoul(line.substr(star + 1).c_str(), nullptr, 16) != crc(line.substr(0, star))) {
      return ended("ERR checksum mismatch");
    }
    checked_ = true;
    line.resize(star);
  } else if (checked_) {
    return ended("ERR checksum required");
  }
  std::istringstream words(line);
  std::string can;
  std::string send;
  std::string number;
  std::string hex;
  words >> can >> send >> number >> hex;
  if (can != "can" || send != "send" || hex.empty()) {
    const bool on = line.starts_with("can on");
    bus_on_ = bus_on_ || on;
    return ended(on ? "OK" : "ERR unknown command");
  }
  if (!bus_on_) return ended("ERR bus off");
  const auto identifier = static_cast<unsigned>(std::strtoul(number.c_str(), nullptr, 16));
  std::vector<std::uint8_t> payload;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    payload.push_back(
        static_cast<std::uint8_t>(std::strtoul(hex.substr(i, 2).c_str(), nullptr, 16)));
  }
  std::string answers = ended("OK");
  if ((identifier & 0x7fu) != 1) return answers;
  const auto reply = frame(payload, now_ns);
  if ((identifier & 0x8000u) == 0 || reply.empty()) return answers;
  std::string received = "rcv 100 ";
  for (const std::uint8_t each : reply) {
    char digits[4];
    std::snprintf(digits, sizeof(digits), "%02X", each);
    received += digits;
  }
  return answers + ended(received + " E B F");
}

std::vector<std::uint8_t> MoteusEmulator::frame(const std::vector<std::uint8_t>& payload,
                                                std::int64_t now_ns) {
  Bytes bytes(payload);
  Command command;
  std::vector<std::uint8_t> reply;
  bool talked = false;
  while (bytes.more()) {
    const unsigned type = bytes.next();
    const unsigned kind = type >> 2 & 3u;
    if (type == 0x50) continue;
    if (type < 0x20) {
      const std::uint32_t count = (type & 3u) != 0 ? type & 3u : bytes.varuint();
      const std::uint32_t first = bytes.varuint();
      if (type < 0x10) {
        for (std::uint32_t i = 0; i < count; ++i) {
          command.write(first + i, bytes.number(first + i, kind));
        }
        continue;
      }
      if (unknown_ >= first && unknown_ < first + count) {
        reply.insert(reply.end(), {0x31, static_cast<std::uint8_t>(unknown_), 1});
        continue;
      }
      if (!talked && command.mode) execute(command, now_ns);  // the reply shows what the frame did
      talked = true;
      reply.push_back(static_cast<std::uint8_t>(0x20u | kind << 2 | (count <= 3 ? count : 0u)));
      if (count > 3) reply.push_back(static_cast<std::uint8_t>(count));
      put_varuint(reply, first);
      for (std::uint32_t i = 0; i < count; ++i) {
        put(reply, first + i, kind, of_register(first + i, now_ns));
      }
    } else if (type == 0x40) {
      bytes.varuint();
      console(bytes.text(bytes.varuint()));
    } else if (type == 0x42) {
      bytes.varuint();
      const std::string piece = console_out_.substr(0, bytes.varuint());
      console_out_.erase(0, piece.size());
      reply.insert(reply.end(), {0x41, 1, static_cast<std::uint8_t>(piece.size())});
      for (const char c : piece) reply.push_back(static_cast<std::uint8_t>(c));
    } else {
      break;
    }
  }
  if (!talked && command.mode) execute(command, now_ns);
  if (!command.mode && talked) ++record_.queries;
  return reply;
}

void MoteusEmulator::execute(const Command& command, std::int64_t now_ns) {
  if (*command.mode == 0) {
    ++record_.stops;
    mode_ = fault_ = 0;
    since_stop_ = 0;
    torque(now_ns);
    return;
  }
  if (*command.mode != 10) {
    ++record_.other_modes;
    return;
  }
  ++record_.commands;
  if (std::isnan(command.timeout)) ++record_.without_watchdog;
  if (!std::isnan(command.position) || command.kp != 0.0 || command.kd != 0.0 ||
      command.ilimit != 0.0) {
    ++record_.with_gains;
  }
  if (std::isnan(command.most)) ++record_.without_bound;
  // A fault and a timeout latch until a stop.
  if (mode_ == 1 || mode_ == 11) return;
  if (mode_ != 10) hold_rev_ = senses_.position_rev;
  if (!std::isnan(command.position)) hold_rev_ = command.position;
  if (since_stop_++ == 0) {
    record_.first_torque_n_m = std::max(record_.first_torque_n_m, std::abs(command.torque));
  }
  mode_ = 10;
  kp_ = command.kp;
  kd_ = std::min(command.kd, command.kp);
  forward_n_m_ = command.torque;
  most_n_m_ = command.most;
  watchdog_s_ = command.timeout == 0.0 ? setting("servo.default_timeout_s") : command.timeout;
  command_ns_ = now_ns;
  torque(now_ns);
}

void MoteusEmulator::torque(std::int64_t now_ns) {
  double wanted_n_m = 0.0;
  if (mode_ == 10) {
    wanted_n_m = kKp * kp_ * (hold_rev_ - senses_.position_rev) -
                 kKd * kd_ * senses_.velocity_rev_s + forward_n_m_;
    if (!std::isnan(most_n_m_)) wanted_n_m = std::clamp(wanted_n_m, -most_n_m_, most_n_m_);
  } else if (mode_ == 11 && setting("servo.timeout_mode") != 0.0) {
    const double most_n_m = setting("servo.timeout_max_torque_Nm");
    wanted_n_m = std::clamp(-kTimeoutKd * senses_.velocity_rev_s, -most_n_m, most_n_m);
  }
  torque_n_m_ = wanted_n_m;
  record_.most_torque_n_m = std::max(record_.most_torque_n_m, std::abs(torque_n_m_));
  if (torque_n_m_ != 0.0) {
    record_.torque_after_ms =
        std::max(record_.torque_after_ms, 1e-6 * static_cast<double>(now_ns - command_ns_));
  }
}

void MoteusEmulator::tick(std::int64_t now_ns) {
  // In mode 10 alone.  NaN: no watchdog.
  if (mode_ == 10 && 1e-9 * static_cast<double>(now_ns - command_ns_) > watchdog_s_) {
    mode_ = 11;
    ++record_.timeouts;
  }
  torque(now_ns);
}

void MoteusEmulator::console(std::string_view text) {
  console_in_ += text;
  for (std::size_t end = 0; (end = console_in_.find('\n')) != std::string::npos;) {
    char verb[8] = {};
    char name[64] = {};
    char value[32] = {};
    const std::string line = console_in_.substr(0, end);
    console_in_.erase(0, end + 1);
    const int words = std::sscanf(line.c_str(), "conf %7s %63s %31s", verb, name, value);
    const auto known = settings_.find(name);
    if (words < 2 || known == settings_.end()) {
      console_out_ += "ERR unknown\r\n";
    } else if (std::strcmp(verb, "get") == 0) {
      console_out_ += known->second + "\r\n";
    } else {
      known->second = value;
      console_out_ += "OK\r\n";
    }
  }
}

double MoteusEmulator::of_register(std::uint32_t address, std::int64_t now_ns) const {
  // Converters of 12 bit.
  const auto converted = [](double share) {
    return std::round(std::clamp(share, 0.0, 1.0) * 4095.0) / 4095.0;
  };
  switch (address) {
    case 0x00:
      return mode_;
    case 0x01:
      return lost_ ? kNaN : senses_.position_rev;
    case 0x02:
      return senses_.velocity_rev_s;
    case 0x03:
      return torque_n_m_;
    case 0x0d:
      return 24.0;
    case 0x0e:
      return 30.0;
    case 0x0f:
      return fault_;
    case 0x60:
      return converted(senses_.analog1);
    case 0x68:
      return converted(senses_.analog2);
    case 0x70:
      return std::floor(1e-6 * static_cast<double>(now_ns - began_ns_));
    case 0x120:
      return serial_;
    case 0x121:
      return 0x5030;
    case 0x122:
      return 0x3230;
    default:
      return 0.0;
  }
}

}  // namespace stillhand::emulators
