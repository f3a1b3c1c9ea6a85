// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string_view>
#include <thread>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/line_splitter.hpp"
#include "services/core/device_rig/reply_clock.hpp"
#include "services/system/process/latest_value.hpp"
#include "services/system/transport/bell.hpp"
#include "services/system/transport/serial_port.hpp"

namespace stillhand::device_rig {

/// What the thread of an indicator knows.
struct IndicatorSample {
  std::uint64_t count = 0;     ///< of young lines; 0: none yet
  std::int64_t at_ns = 0;      ///< CLOCK_MONOTONIC when the newest was read
  double force_n = 0.0;        ///< as its sign says; NaN: overload
  std::uint64_t damaged = 0;   ///< lines that were not understood
  std::uint64_t old = 0;       ///< lines that waited in a buffer (DR-10)
  std::int64_t old_at_ns = 0;  ///< when the newest of these was read; 0: never
};

/// A load cell indicator that streams lines to a serial port, in a thread of its own.  The loop
/// takes the newest line without lock or allocation and judges its age by itself.  Nothing is ever
/// sent.  METHOD Eq. DR-36.
class IndicatorLink {
 public:
  /// Opens the port and listens for a second, three if the lines do not come as the settings say.
  /// @throws ConfigError for a port that is not there, lines that are none of an indicator, or
  ///         another rate than the settings say
  explicit IndicatorLink(const IndicatorConfig& config);
  ~IndicatorLink();
  IndicatorLink(const IndicatorLink&) = delete;
  IndicatorLink& operator=(const IndicatorLink&) = delete;

  const IndicatorSample& newest() noexcept { return samples_.load(); }

 private:
  void listen_first();
  void work(const std::stop_token& stop) noexcept;
  void open_again() noexcept;
  void receive() noexcept;
  void take(std::string_view line) noexcept;

  IndicatorConfig config_;
  std::unique_ptr<runtime::SerialPort> port_;
  runtime::Bell bell_;
  runtime::LatestValue<IndicatorSample> samples_;
  // The thread's.
  IndicatorSample sample_;
  LineSplitter lines_;
  ReplyClock clock_;
  std::uint64_t number_ = 0;  ///< of lines since the port was opened
  std::int64_t line_ns_ = 0;  ///< when the newest of them was read
  std::jthread thread_;       // last
};

}  // namespace stillhand::device_rig
