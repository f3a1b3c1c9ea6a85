// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/emulated_loop.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "services/system/process/clock.hpp"

namespace stillhand::emulators {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;

int listen_at(std::uint16_t port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    throw std::runtime_error("UDP port " + std::to_string(port) + " is taken");
  }
  return descriptor;
}

}  // namespace

EmulatedLoop::EmulatedLoop(const LoopOptions& options, const rig::RigConfig& rig)
    : drive_(options.uart),
      serial_(options.drive_link),
      laboratory_(rig, drive_, platform_),
      socket_(listen_at(options.platform_port)) {
  for (const std::string& each : options.settings) {
    const std::size_t equals = each.find('=');
    if (equals == std::string::npos) throw std::runtime_error("--set " + each + ": no =");
    drive_.set(each.substr(0, equals), each.substr(equals + 1));
  }
  if (!options.accelerometer.empty()) iio_.emplace(options.accelerometer, options.bridge);
  drive_.begin(runtime::monotonic_ns());
}

EmulatedLoop::~EmulatedLoop() { close(socket_); }

void EmulatedLoop::run(Person* person) {
  std::int64_t due_ns = runtime::monotonic_ns() + kPeriod_ns;
  stepped_ns_ = due_ns;
  std::puts("ready");
  std::fflush(stdout);
  while (true) {
    std::array<pollfd, 3> wanted{pollfd{STDIN_FILENO, POLLIN, 0}, pollfd{socket_, POLLIN, 0},
                                 pollfd{serial_.descriptor(), POLLIN, 0}};
    const std::int64_t left_ns = std::max<std::int64_t>(0, due_ns - runtime::monotonic_ns());
    const timespec left{0, left_ns};
    ppoll(wanted.data(), wanted.size(), &left, nullptr);
    const std::int64_t now_ns = runtime::monotonic_ns();
    if (wanted[2].revents != 0 && serial_.descriptor() >= 0) hear_drive(now_ns);
    if (wanted[1].revents != 0) hear_platform(now_ns);
    if (wanted[0].revents != 0 && !hear_orders(now_ns)) return;
    serial_.send_due(now_ns);
    if (now_ns < due_ns) continue;
    laboratory_.step(now_ns, person);
    if (iio_) iio_->write(laboratory_.raw(), now_ns);
    if (drive_.torque_n_m() != 0.0) torque_until_ns_ = now_ns;
    if (platform_.wish(now_ns)) platform_until_ns_ = now_ns;
    worst_step_ns_ = std::max(worst_step_ns_, now_ns - stepped_ns_);
    stepped_ns_ = now_ns;
    due_ns += kPeriod_ns;
    // Far behind, it goes on from now; a little behind, it catches up.
    if (now_ns - due_ns > 100 * kPeriod_ns) due_ns = now_ns;
  }
}

void EmulatedLoop::hear_drive(std::int64_t now_ns) {
  serial_.write(drive_.take(serial_.read(), now_ns), now_ns);
}

void EmulatedLoop::hear_platform(std::int64_t now_ns) {
  std::array<std::uint8_t, 256> bytes{};
  sockaddr_in from{};
  socklen_t size = sizeof(from);
  auto* address = reinterpret_cast<sockaddr*>(&from);
  const ssize_t count = recvfrom(socket_, bytes.data(), bytes.size(), 0, address, &size);
  if (count <= 0) return;
  std::bernoulli_distribution lost(platform_loses_);
  if (lost(dice_)) return;
  const auto reply = platform_.take({bytes.data(), static_cast<std::size_t>(count)}, now_ns);
  if (!reply.empty() && !platform_silent_ && !lost(dice_)) {
    sendto(socket_, reply.data(), reply.size(), 0, address, size);
  }
}

bool EmulatedLoop::hear_orders(std::int64_t now_ns) {
  std::array<char, 512> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count <= 0) return false;
  orders_.append(bytes.data(), static_cast<std::size_t>(count));
  for (std::size_t end = 0; (end = orders_.find('\n')) != std::string::npos;) {
    execute(orders_.substr(0, end), now_ns);
    orders_.erase(0, end + 1);
  }
  return true;
}

void EmulatedLoop::execute(const std::string& line, std::int64_t now_ns) {
  std::istringstream words(line);
  std::string word;
  double value = 1.0;
  words >> word;
  if (word == "report") return report(now_ns);
  if (word == "set") {
    std::string name;
    std::string text;
    words >> name >> text;
    return drive_.set(name, text);
  }
  words >> value;
  fault_ns_ = now_ns;
  fault_torque_n_m_ = drive_.torque_n_m();
  if (word == "mark") return;  // a fault that is made elsewhere begins now
  if (!execute_platform(word, value) && !execute_laboratory(word, value) &&
      !execute_drive(word, value, now_ns) && !execute_way(word, value) &&
      !execute_iio(word, value)) {
    std::fprintf(stderr, "emulated_laboratory: no order \"%s\"\n", word.c_str());
  }
}

bool EmulatedLoop::execute_platform(const std::string& word, double value) {
  if (word == "platform_silent") {
    platform_silent_ = value != 0.0;
  } else if (word == "platform_loses") {
    platform_loses_ = std::clamp(value, 0.0, 1.0);
  } else if (word == "platform_fault") {
    platform_.fault(static_cast<std::uint32_t>(value));
  } else {
    return false;
  }
  return true;
}

bool EmulatedLoop::execute_laboratory(const std::string& word, double value) {
  if (word == "slip") {
    laboratory_.slip(value);
  } else if (word == "saturate") {
    laboratory_.saturate(value != 0.0);
  } else if (word == "seat_unknown") {
    laboratory_.lose_acceleration(value != 0.0);
  } else if (word == "hold") {
    laboratory_.hold_acceleration(value != 0.0);
  } else if (word == "swapped") {
    laboratory_.swap_wires(value != 0.0);
  } else if (word == "turned") {
    laboratory_.turn_round(value != 0.0);
  } else if (word == "pull") {
    laboratory_.pull(value);
  } else if (word == "tilt") {
    laboratory_.tilt(value);
  } else if (word == "turn") {
    laboratory_.turn(value);
  } else {
    return false;
  }
  return true;
}

bool EmulatedLoop::execute_drive(const std::string& word, double value, std::int64_t now_ns) {
  if (word == "reboot") {
    drive_.reboot(now_ns);
  } else if (word == "fault") {
    drive_.fault(static_cast<int>(value));
  } else if (word == "firmware") {
    drive_.forget(static_cast<std::uint32_t>(value));
  } else if (word == "nan") {
    drive_.lose_position(value != 0.0);
  } else if (word == "serial") {
    drive_.be(static_cast<std::uint32_t>(value));
  } else {
    return false;
  }
  return true;
}

bool EmulatedLoop::execute_iio(const std::string& word, double value) {
  if (!iio_) return false;
  if (word == "iio_starved") {
    iio_->starve(value != 0.0);
  } else if (word == "iio_saturated") {
    iio_->saturate(value != 0.0);
  } else {
    return false;
  }
  return true;
}

bool EmulatedLoop::execute_way(const std::string& word, double value) {
  const std::map<std::string, bool*> switches{
      {"silent", &serial_.mischief.silent},       {"deaf", &serial_.mischief.deaf},
      {"garbage", &serial_.mischief.garbage},     {"damaged", &serial_.mischief.damaged},
      {"truncated", &serial_.mischief.truncated}, {"repeated", &serial_.mischief.repeated}};
  if (const auto found = switches.find(word); found != switches.end()) {
    *found->second = value != 0.0;
  } else if (word == "late") {
    serial_.mischief.late_ms = value;
  } else if (word == "cable") {
    value != 0.0 ? serial_.put_in() : serial_.pull_out();
  } else {
    return false;
  }
  return true;
}

void EmulatedLoop::report(std::int64_t now_ns) const {
  const DriveRecord& drive = drive_.record();
  const auto since_fault_ms = [this](std::int64_t at_ns) {
    return fault_ns_ == 0 ? -1.0 : 1e-6 * static_cast<double>(at_ns - fault_ns_);
  };
  nlohmann::json json{
      {"mode", drive_.mode()},
      {"follows", drive_.follows()},
      {"torque_n_m", drive_.torque_n_m()},
      {"commands", drive.commands},
      {"stops", drive.stops},
      {"queries", drive.queries},
      {"other_modes", drive.other_modes},
      {"without_watchdog", drive.without_watchdog},
      {"with_gains", drive.with_gains},
      {"without_bound", drive.without_bound},
      {"timeouts", drive.timeouts},
      {"most_torque_n_m", drive.most_torque_n_m},
      {"first_torque_n_m", drive.first_torque_n_m},
      {"torque_after_command_ms", drive.torque_after_ms},
      {"fault_torque_n_m", fault_torque_n_m_},
      {"torque_after_fault_ms", std::max(0.0, since_fault_ms(torque_until_ns_))},
      {"since_fault_ms", since_fault_ms(now_ns)},
      {"worst_step_ms", 1e-6 * static_cast<double>(worst_step_ns_)},
      {"platform_after_fault_ms", std::max(0.0, since_fault_ms(platform_until_ns_))},
      {"platform_commands", platform_.commands()},
      {"platform_refused", platform_.refused()},
      {"platform_most_step_m", platform_.most_step_m()},
      {"platform_position_m", laboratory_.truth().platform_position_m}};
  if (iio_) {
    json["iio_longest_gap_ms"] = 1e-6 * static_cast<double>(iio_->counts().longest_gap_ns);
    json["iio_lost"] = iio_->counts().lost;
  }
  std::printf("%s\n", json.dump().c_str());
  std::fflush(stdout);
}

}  // namespace stillhand::emulators
