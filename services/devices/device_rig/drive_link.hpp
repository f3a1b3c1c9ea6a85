// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/drive_protocol.hpp"
#include "services/core/device_rig/reply_clock.hpp"
#include "services/system/process/latest_value.hpp"
#include "services/system/transport/bell.hpp"
#include "services/system/transport/port.hpp"

namespace stillhand::device_rig {

/// What the drive's thread knows.
struct DriveSample {
  std::uint64_t sequence = 0;  ///< of whole replies; 0: none yet
  std::int64_t at_ns = 0;      ///< CLOCK_MONOTONIC when the reply was read
  bool checked = false;        ///< its settings are read back and right
  DriveReply reply;
  std::uint64_t damaged = 0;  ///< answers that were not understood, or not whole
  std::uint64_t late = 0;     ///< replies that were held up, or came again and again
  std::uint64_t unsent = 0;   ///< commands that were too old, or that the port did not take
};

/// A drive behind a port, in a thread of its own; DriveProtocol is its language.  The loop
/// only stores a demand and takes the newest sample: no lock, no allocation, one system call.  The
/// thread sends each demand once and none by itself, so a loop that stops stops the drive (its
/// watchdog).  A demand that is older than 5 ms is not sent.
class DriveLink final : private DriveListener {
 public:
  /// Opens the port, switches the driver off, and reads the drive's settings back; 3 s at most.
  /// @throws ConfigError if there is no drive, or a setting is wrong, with the command that mends
  /// it
  DriveLink(const DriveConfig& config, const SettingLimits& limits);
  /// Switches the driver off.
  ~DriveLink();
  DriveLink(const DriveLink&) = delete;
  DriveLink& operator=(const DriveLink&) = delete;

  void demand(Order order, double torque_n_m) noexcept;
  const DriveSample& newest() noexcept { return samples_.load(); }
  /// Serial number of the drive that was opened, in hexadecimal digits; "unknown" if it has none.
  [[nodiscard]] std::string serial() const { return opened_.value_or("unknown"); }

 private:
  struct Demand {
    std::uint64_t number = 0;
    std::int64_t at_ns = 0;
    Order order = Order::kQuery;
    double torque_n_m = 0.0;
  };

  void work(const std::stop_token& stop) noexcept;
  void open_again();
  bool check_again();
  void send(std::string_view bytes) noexcept;
  void send_demand() noexcept;
  void receive() noexcept;
  void state(const DriveReply& reply) noexcept override;
  void damaged() noexcept override { ++sample_.damaged; }
  /// Waits for what comes, at most until a time of CLOCK_MONOTONIC.
  template <typename IsThere>
  bool receive_until(std::int64_t until_ns, IsThere is_there) noexcept;
  /// Sends stops and waits for their replies.  @returns the shortest time between [ms]; nothing if
  /// no reply came
  std::optional<double> round_trip_ms();
  /// Reads the settings back.  @returns the first that is wrong
  std::optional<SettingFault> wrong_setting();
  std::optional<std::string> ask(std::string_view name);
  /// Asks the drive who it is.
  std::optional<std::string> ask_serial();

  DriveConfig config_;
  std::unique_ptr<DriveProtocol> protocol_;
  std::unique_ptr<runtime::Port> port_;
  runtime::Bell bell_;
  runtime::LatestValue<Demand> demands_;
  runtime::LatestValue<DriveSample> samples_;
  std::uint64_t demand_number_ = 0;    // the loop's
  std::optional<std::string> opened_;  ///< serial number of the drive that was opened; constant
  // The thread's.
  ReplyClock reply_clock_;
  DriveSample sample_;
  std::uint64_t sent_number_ = 0;
  bool piece_sent_ = false;  ///< the port took a part of a message
  bool unchecked_ = false;   ///< the settings are to be read back once more
  std::jthread thread_;      // last
};

}  // namespace stillhand::device_rig
