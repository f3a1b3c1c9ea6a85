// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

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

/// Channels of an IIO device, sampled together, on this machine or behind an iiod, by libiio.  One
/// thread, but for cancel().  libiio 0.24 writes to connections that are gone: the process has to
/// ignore SIGPIPE, as runtime::Stop does.
class IioDevice {
 public:
  /// Opens the device and its buffer.
  /// @param uri      libiio's: "local:", "ip:192.168.1.20"
  /// @param device   name or id
  /// @param channels  ids of input channels, {"accel_y"}; at least one
  /// @param reads_hz  a device that samples more often is read in blocks: behind an iiod each read
  ///                  is a round trip
  /// @throws ConfigError for a context, a device or a channel that is not there, with those that
  /// are; for a device that samples less often
  IioDevice(std::string uri, std::string device, std::vector<std::string> channels,
            double reads_hz);
  ~IioDevice();
  IioDevice(const IioDevice&) = delete;
  IioDevice& operator=(const IioDevice&) = delete;

  /// Waits for the next block of samples, 1 s at most where the context keeps its time-out; a
  /// pulled cable may hold it for ever, until cancel().
  /// @param numbers  those of the converter in the newest sample, one a channel
  /// @returns false if none came: all is closed then, and the next call opens it again.  Not one of
  ///          another serial number, or one that became slower.
  bool read(std::span<std::int64_t> numbers);
  /// Samples that a read takes.
  [[nodiscard]] std::size_t block() const noexcept { return block_; }
  /// Throws away what waits in the buffers on the way: the next sample is taken after this call.
  void skip() noexcept;
  /// Ends a read() that waits, and all later ones.  Any thread.
  void cancel() noexcept;

  /// Of the channels, in their order.
  [[nodiscard]] const std::vector<IioFormat>& formats() const noexcept { return formats_; }
  /// `sampling_frequency` of the device [Hz]; 0: it does not say.
  [[nodiscard]] double rate_hz() const noexcept { return rate_hz_; }
  /// `serial_number` of the device (a debug attribute of some drivers) or `hw_serial` of the
  /// context; "unknown": neither is there.
  [[nodiscard]] const std::string& serial() const noexcept { return serial_; }

 private:
  void open();
  void close() noexcept;
  void make_buffer() noexcept;
  [[nodiscard]] iio_device* find_device() const;
  [[nodiscard]] iio_channel* find_channel(const std::string& name) const;

  std::string uri_;
  std::string name_;
  std::vector<std::string> channel_names_;
  std::vector<IioFormat> formats_;
  double reads_hz_;
  double rate_hz_ = 0.0;
  std::size_t block_ = 1;
  std::string serial_;
  iio_context* context_ = nullptr;
  iio_device* device_ = nullptr;
  std::vector<iio_channel*> channels_;
  std::mutex mutex_;  ///< guards what follows against cancel()
  iio_buffer* buffer_ = nullptr;
  bool cancelled_ = false;
};

}  // namespace stillhand::runtime
