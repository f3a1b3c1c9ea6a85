// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/drive_link.hpp"

#include <algorithm>
#include <array>

#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/moteus_can.hpp"
#include "services/core/device_rig/moteus_protocol.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/files/settings/placed_error.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/transport/can_socket.hpp"
#include "services/system/transport/serial_port.hpp"

namespace stillhand::device_rig {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000;
// A demand that waited for so long is of an earlier state of the stick.
constexpr std::int64_t kOldest_ns = 5 * kMs_ns;
constexpr std::int64_t kAnswerLimit_ns = 1000 * kMs_ns;
// A drive that answers later than this is of no use at 1 kHz; the usual cause is a USB serial chip
// that collects bytes for 16 ms (its latency_timer).  The quickest of some answers counts: a busy
// machine is late now and then, a chip always.
constexpr double kSlowest_ms = 10.0;
constexpr int kTrips = 5;
constexpr std::int64_t kPollEach_ns = 10 * kMs_ns;
constexpr int kWait_ms = 100;

// The protocol of the drive that the settings name.  A new drive is a branch here and in port_of().
std::unique_ptr<DriveProtocol> protocol_of(const DriveConfig& config, const SettingLimits& limits) {
  if (drive_of(config) == Parts::Drive::kMoteusCan) {
    return std::make_unique<moteus::MoteusCan>(config, limits);
  }
  return std::make_unique<moteus::MoteusLines>(config, limits);
}

std::unique_ptr<runtime::Port> port_of(const DriveConfig& config) {
  if (drive_of(config) == Parts::Drive::kMoteusCan) {
    return std::make_unique<runtime::CanSocket>(config.port);
  }
  return std::make_unique<runtime::SerialPort>(config.port);
}

}  // namespace

DriveLink::DriveLink(const DriveConfig& config, const SettingLimits& limits)
    : config_(config),
      protocol_(protocol_of(config, limits)),
      port_(settings::placed("devices.drive.port", [&] { return port_of(config); })) {
  const std::string drive = protocol_->name() + " at " + config.port;
  port_->write(protocol_->greeting());
  const auto trip_ms = round_trip_ms();
  if (!trip_ms) throw ConfigError(drive, "no answer", std::string(protocol_->needs()));
  if (*trip_ms > kSlowest_ms) {
    throw ConfigError(drive, "an answer after " + std::to_string(*trip_ms) + " ms",
                      "at most 10 ms (latency_timer of a USB serial chip: 1)");
  }
  if (const auto fault = wrong_setting()) {
    throw ConfigError(drive + ": " + fault->name, fault->got,
                      fault->want + "; this mends it: " + fault->mend);
  }
  opened_ = ask_serial();
  sample_.checked = true;
  samples_.store(sample_);
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

DriveLink::~DriveLink() {
  thread_.request_stop();
  bell_.ring();
}

void DriveLink::demand(Order order, double torque_n_m) noexcept {
  demands_.store({++demand_number_, runtime::monotonic_ns(), order, torque_n_m});
  bell_.ring();
}

void DriveLink::work(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    bell_.wait(port_ ? port_->descriptor() : -1, kWait_ms);
    if (!port_ || port_->gone()) open_again();
    if (!port_) continue;
    receive();
    if (unchecked_) {
      unchecked_ = !check_again();
    } else {
      send_demand();
    }
  }
  if (port_) send(protocol_->order(Order::kStop, 0.0));
}

// A cable that was pulled and put in again: the drive may be another one.
void DriveLink::open_again() {
  port_.reset();
  sample_.checked = false;
  samples_.store(sample_);
  unchecked_ = true;
  try {
    port_ = port_of(config_);
    port_->write(protocol_->greeting());
  } catch (const std::exception&) {
    // Not there yet: the next turn tries again.  Nothing rings meanwhile as often as the loop.
    runtime::sleep_until_ns(runtime::monotonic_ns() + kWait_ms * kMs_ns);
  }
}

bool DriveLink::check_again() {
  protocol_->clear();
  // A command that was under way may have armed the drive that started again.
  send(protocol_->order(Order::kStop, 0.0));
  // What is still under way does not answer what is asked now.
  receive_until(runtime::monotonic_ns() + kAnswerLimit_ns, [] { return false; });
  if (port_->gone()) return false;
  reply_clock_.clear();
  const auto trip_ms = round_trip_ms();
  // Another drive has another zero of its angle, and amplifiers that nobody calibrated.
  const bool good =
      trip_ms && *trip_ms <= kSlowest_ms && !wrong_setting() && ask_serial() == opened_;
  sample_.checked = good;
  samples_.store(sample_);
  return good;
}

void DriveLink::send(std::string_view bytes) noexcept {
  if (bytes.empty()) return;
  // What the port took of the message before ends first.
  const std::string_view end = protocol_->end_of_piece();
  if (piece_sent_ && !end.empty() && !port_->write(end)) {
    ++sample_.unsent;
    return;
  }
  piece_sent_ = !port_->write(bytes);
  if (piece_sent_) ++sample_.unsent;
}

void DriveLink::send_demand() noexcept {
  const Demand& demand = demands_.load();
  if (demand.number == sent_number_) return;
  sent_number_ = demand.number;
  if (runtime::monotonic_ns() - demand.at_ns > kOldest_ns) {
    ++sample_.unsent;
    return;
  }
  send(protocol_->order(demand.order, demand.torque_n_m));
}

void DriveLink::receive() noexcept {
  std::array<char, 1024> bytes{};
  // A device that never stops talking does not hold the thread.
  for (int turn = 0; turn < 8; ++turn) {
    const std::string_view text = port_->read(bytes);
    if (text.empty()) return;
    protocol_->take(text, *this);
  }
}

void DriveLink::state(const DriveReply& reply) noexcept {
  const std::int64_t now_ns = runtime::monotonic_ns();
  switch (reply_clock_.step(reply.milliseconds, 1e-6 * static_cast<double>(now_ns))) {
    case ReplyClock::Verdict::kYoung:
    case ReplyClock::Verdict::kDrifted:  // no limit: a drive's replies wait for no reader of ours
      ++sample_.sequence;
      sample_.at_ns = now_ns;
      sample_.reply = reply;
      break;
    case ReplyClock::Verdict::kOld:
    case ReplyClock::Verdict::kTooSlow:
      ++sample_.late;
      break;
    case ReplyClock::Verdict::kRestarted:
      // It has the settings of its memory now, which may be others.
      sample_.checked = false;
      unchecked_ = true;
      break;
  }
  samples_.store(sample_);
}

template <typename IsThere>
bool DriveLink::receive_until(std::int64_t until_ns, IsThere is_there) noexcept {
  while (!is_there()) {
    const std::int64_t left_ns = until_ns - runtime::monotonic_ns();
    if (left_ns <= 0 || port_->gone()) return false;
    bell_.wait(port_->descriptor(), static_cast<int>(std::min(left_ns, kPollEach_ns) / kMs_ns) + 1);
    receive();
  }
  return true;
}

std::optional<double> DriveLink::round_trip_ms() {
  std::optional<double> quickest_ms;
  int trips = 0;
  for (int attempt = 0; attempt < 2 * kTrips && trips < kTrips; ++attempt) {
    const std::uint64_t before = sample_.sequence;
    const std::int64_t sent_ns = runtime::monotonic_ns();
    send(protocol_->order(Order::kStop, 0.0));
    if (receive_until(sent_ns + kAnswerLimit_ns / 10, [&] { return sample_.sequence > before; })) {
      const double trip_ms = 1e-6 * static_cast<double>(runtime::monotonic_ns() - sent_ns);
      quickest_ms = std::min(trip_ms, quickest_ms.value_or(trip_ms));
      ++trips;
    }
  }
  return quickest_ms;
}

std::optional<SettingFault> DriveLink::wrong_setting() {
  for (const std::string_view name : protocol_->settings()) {
    const auto answer = ask(name);
    if (auto fault = protocol_->judge(name, answer.value_or("no answer"))) return fault;
  }
  return std::nullopt;
}

std::optional<std::string> DriveLink::ask(std::string_view name) {
  send(protocol_->ask(name));
  const std::int64_t until_ns = runtime::monotonic_ns() + kAnswerLimit_ns;
  while (runtime::monotonic_ns() < until_ns && !port_->gone()) {
    send(protocol_->poll());
    const std::int64_t next_ns = runtime::monotonic_ns() + kPollEach_ns;
    if (receive_until(next_ns, [&] { return protocol_->answer().has_value(); })) {
      return protocol_->answer();
    }
  }
  return std::nullopt;
}

std::optional<std::string> DriveLink::ask_serial() {
  // A firmware that does not know its serial number answers with an error.
  std::optional<std::string> serial;
  for (int attempt = 0; attempt < kTrips && !serial && !port_->gone(); ++attempt) {
    send(protocol_->ask_serial());
    receive_until(runtime::monotonic_ns() + kAnswerLimit_ns / 10, [&] {
      serial = protocol_->serial();
      return serial.has_value();
    });
  }
  return serial;
}

}  // namespace stillhand::device_rig
