// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/reply_clock.hpp"
#include "services/system/process/latest_value.hpp"
#include "services/system/transport/iio_device.hpp"

namespace stillhand::device_rig {

inline constexpr std::size_t kMostChannels = 3;

/// What the thread of an IIO device knows.
struct IioSample {
  std::uint64_t count = 0;  ///< of young samples; 0: none yet
  std::int64_t at_ns = 0;   ///< CLOCK_MONOTONIC when the newest was read
  /// [m/s^2] or [V], one a channel; NaN: at an end of the converter's range
  std::array<double, kMostChannels> values{};
  std::uint64_t old = 0;       ///< samples that waited in a buffer (DR-10)
  std::int64_t old_at_ns = 0;  ///< when the newest of these was read; 0: never
  std::uint64_t skipped = 0;   ///< times that what waited was thrown away
  std::uint64_t opened = 0;    ///< times that the buffer was opened again
  std::int64_t longest_read_ns = 0;
  std::int64_t longest_skip_ns = 0;
};

/// For the end of a session: "61234 samples, 12 old, ...".
std::string in_words(const IioSample& sample);

/// An IIO device, in a thread of its own: a read may wait for ever.  The loop takes the newest
/// sample without lock or allocation and judges its age by itself (METHOD Eq. DR-13).
class IioLink {
 public:
  /// @param channels  at most three, sampled together
  /// @param factor    of libiio's unit: 1 for an acceleration, 0.001 for mV
  /// @throws ConfigError for a device that is not there, or that gives less than one sample a tick
  IioLink(const IioConfig& config, std::vector<std::string> channels, double factor);
  ~IioLink();
  IioLink(const IioLink&) = delete;
  IioLink& operator=(const IioLink&) = delete;

  const IioSample& newest() noexcept { return samples_.load(); }
  /// Serial number of the device when it was opened, or "unknown".
  [[nodiscard]] const std::string& serial() const noexcept { return serial_; }

 private:
  void work(const std::stop_token& stop);
  void take(std::span<const std::int64_t> raw) noexcept;
  void take_old(std::int64_t now_ns, bool too_slow) noexcept;
  void skip() noexcept;
  void begin_again() noexcept;

  double factor_;
  runtime::IioDevice device_;
  std::string serial_ = device_.serial();  ///< the thread may open the device again
  runtime::LatestValue<IioSample> samples_;
  // The thread's.
  IioSample sample_;
  ReplyClock clock_{ReplyClock::kStreamDrift_ms};
  std::uint64_t number_ = 0;    ///< of samples since the buffer was opened
  std::int64_t behind_ns_ = 0;  ///< since when every sample is old; 0: the newest is young
  std::jthread thread_;         // last
};

}  // namespace stillhand::device_rig
