// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

struct iio_buffer;
struct iio_channel;
struct iio_context;
struct iio_device;

namespace stillhand::runtime {

/// What a channel's numbers mean: value = (raw + offset) * scale, in m/s^2 of an acceleration and
/// in mV of a voltage (Linux, Documentation/ABI/testing/sysfs-bus-iio).
struct IioFormat {
  double offset = 0.0;
  double scale = 1.0;
  std::int64_t lowest = 0;   ///< raw numbers of the converter
  std::int64_t highest = 0;  ///< the same
};

/// One channel of an IIO device, on this machine or behind an iiod, by libiio.  One thread, but for
/// cancel().  libiio 0.24 writes to connections that are gone: the process has to ignore SIGPIPE,
/// as runtime::Stop does.
class IioDevice {
 public:
  /// Opens the device and its buffer of one sample.
  /// @param uri      libiio's: "local:", "ip:192.168.1.20"
  /// @param device   name or id
  /// @param channel  id of an input channel, "accel_y"
  /// @throws ConfigError for a context, a device or a channel that is not there, with those that
  /// are
  IioDevice(std::string uri, std::string device, std::string channel);
  ~IioDevice();
  IioDevice(const IioDevice&) = delete;
  IioDevice& operator=(const IioDevice&) = delete;

  /// Waits for the next sample, 1 s at most where the context keeps its time-out; a pulled cable
  /// may hold it for ever, until cancel().
  /// @returns the converter's number; nothing if none came: all is closed then, and the next call
  ///          opens it again
  std::optional<std::int64_t> read();
  /// Ends a read() that waits, and all later ones.  Any thread.
  void cancel() noexcept;

  [[nodiscard]] const IioFormat& format() const noexcept { return format_; }
  /// `sampling_frequency` of the device [Hz]; 0: it does not say.
  [[nodiscard]] double rate_hz() const noexcept { return rate_hz_; }
  /// `serial_number` of the device (a debug attribute of some drivers) or `hw_serial` of the
  /// context; "unknown": neither is there.
  [[nodiscard]] const std::string& serial() const noexcept { return serial_; }

 private:
  void open();
  void close() noexcept;
  [[nodiscard]] iio_device* find_device() const;
  [[nodiscard]] iio_channel* find_channel() const;

  std::string uri_;
  std::string name_;
  std::string channel_name_;
  IioFormat format_;
  double rate_hz_ = 0.0;
  std::string serial_ = "unknown";
  iio_context* context_ = nullptr;
  iio_device* device_ = nullptr;
  iio_channel* channel_ = nullptr;
  std::mutex mutex_;  ///< guards what follows against cancel()
  iio_buffer* buffer_ = nullptr;
  bool cancelled_ = false;
};

}  // namespace stillhand::runtime
