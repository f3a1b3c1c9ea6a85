// SPDX-License-Identifier: Apache-2.0
#include "services/system/transport/iio_device.hpp"

#include <iio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <system_error>
#include <utility>

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {
namespace {

constexpr unsigned kTimeout_ms = 1000;

std::string listed(const std::string& list, const char* name) {
  return list + (list.empty() ? "" : ", ") + name;
}

IioFormat format_of(const iio_channel* channel) {
  const iio_data_format& data = *iio_channel_get_data_format(channel);
  IioFormat format;
  // A channel without one of the two has 0 and 1.
  iio_channel_attr_read_double(channel, "offset", &format.offset);
  iio_channel_attr_read_double(channel, "scale", &format.scale);
  const unsigned bits = data.is_signed ? data.bits - 1 : data.bits;
  format.highest = (std::int64_t{1} << bits) - 1;
  format.lowest = data.is_signed ? -format.highest - 1 : 0;
  return format;
}

std::string serial_of(const iio_context* context, const iio_device* device) {
  std::array<char, 128> text{};
  if (iio_device_debug_attr_read(device, "serial_number", text.data(), text.size() - 1) > 0) {
    return text.data();
  }
  const char* value = iio_context_get_attr_value(context, "hw_serial");
  return value != nullptr ? value : "unknown";
}

std::string error_text() { return std::generic_category().message(errno); }

template <typename Number>
std::int64_t number_at(const void* bytes) {
  Number number{};
  std::memcpy(&number, bytes, sizeof(number));
  return number;
}

// libiio converts within the width of a sample: byte order, shift and sign.
std::int64_t converted(const iio_channel* channel, const void* sample) {
  std::int64_t bytes = 0;
  iio_channel_convert(channel, &bytes, sample);
  const iio_data_format& data = *iio_channel_get_data_format(channel);
  switch (data.length) {
    case 8:
      return data.is_signed ? number_at<std::int8_t>(&bytes) : number_at<std::uint8_t>(&bytes);
    case 16:
      return data.is_signed ? number_at<std::int16_t>(&bytes) : number_at<std::uint16_t>(&bytes);
    case 32:
      return data.is_signed ? number_at<std::int32_t>(&bytes) : number_at<std::uint32_t>(&bytes);
    default:
      return bytes;
  }
}

}  // namespace

IioDevice::IioDevice(std::string uri, std::string device, std::vector<std::string> channels,
                     double reads_hz)
    : uri_(std::move(uri)),
      name_(std::move(device)),
      channel_names_(std::move(channels)),
      reads_hz_(reads_hz) {
  try {
    open();
  } catch (...) {
    close();
    throw;
  }
}

IioDevice::~IioDevice() { close(); }

iio_device* IioDevice::find_device() const {
  iio_device* device = iio_context_find_device(context_, name_.c_str());
  if (device != nullptr) return device;
  std::string there;
  for (unsigned i = 0; i < iio_context_get_devices_count(context_); ++i) {
    const iio_device* each = iio_context_get_device(context_, i);
    const char* name = iio_device_get_name(each);
    there = listed(there, name != nullptr ? name : iio_device_get_id(each));
  }
  throw ConfigError(
      "IIO device of " + uri_, name_,
      there.empty() ? "a context with devices; this one has none" : "one of " + there);
}

iio_channel* IioDevice::find_channel(const std::string& wanted) const {
  iio_channel* channel = iio_device_find_channel(device_, wanted.c_str(), false);
  if (channel != nullptr && iio_channel_is_scan_element(channel)) return channel;
  std::string there;
  for (unsigned i = 0; i < iio_device_get_channels_count(device_); ++i) {
    const iio_channel* each = iio_device_get_channel(device_, i);
    const bool fits = !iio_channel_is_output(each) && iio_channel_is_scan_element(each);
    if (fits) there = listed(there, iio_channel_get_id(each));
  }
  throw ConfigError(
      "IIO channel of " + name_, wanted,
      there.empty() ? "a device with a buffer; this one has none" : "one of " + there);
}

void IioDevice::open() {
  // libiio 0.24 ends an "ip:" uri at its port, in the caller's own text.
  const std::string uri = uri_;
  context_ = iio_create_context_from_uri(uri.c_str());
  if (context_ == nullptr) {
    throw ConfigError("IIO context " + uri_, error_text(),
                      "a context that `iio_info -u " + uri_ + "` shows");
  }
  // A local context has no time-out of its own; the loop judges the age of a sample by itself.
  [[maybe_unused]] const int unknown = iio_context_set_timeout(context_, kTimeout_ms);
  device_ = find_device();
  formats_.clear();
  for (const std::string& each : channel_names_) {
    channels_.push_back(find_channel(each));
    iio_channel_enable(channels_.back());
    formats_.push_back(format_of(channels_.back()));
  }
  if (iio_device_attr_read_double(device_, "sampling_frequency", &rate_hz_) < 0) rate_hz_ = 0.0;
  // Slower than it is read, and a sample would count twice as a new one.
  if (rate_hz_ > 0.0 && rate_hz_ < reads_hz_) {
    throw ConfigError("sampling_frequency of IIO device " + name_, std::to_string(rate_hz_) + " Hz",
                      "at least " + std::to_string(std::lround(reads_hz_)) + " Hz; `iio_attr -u " +
                          uri_ + " -d " + name_ + " sampling_frequency` sets it");
  }
  const std::string serial = serial_of(context_, device_);
  if (!serial_.empty() && serial != serial_) {
    throw ConfigError("IIO device " + name_, "serial number " + serial,
                      serial_ + ", of the one that was opened first");
  }
  serial_ = serial;
  block_ = static_cast<std::size_t>(std::max(1.0, rate_hz_ / reads_hz_));
  make_buffer();
  if (buffer_ == nullptr) {
    throw ConfigError("buffer of IIO device " + name_, error_text(),
                      "one that no other program has, with a trigger where the device needs one");
  }
}

void IioDevice::make_buffer() noexcept {
  const std::lock_guard lock(mutex_);
  if (!cancelled_) buffer_ = iio_device_create_buffer(device_, block_, false);
}

void IioDevice::skip() noexcept {
  if (buffer_ == nullptr) return;
  {
    const std::lock_guard lock(mutex_);
    iio_buffer_destroy(buffer_);
    buffer_ = nullptr;
  }
  make_buffer();
  if (buffer_ == nullptr) close();
}

void IioDevice::close() noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (buffer_ != nullptr) iio_buffer_destroy(buffer_);
    buffer_ = nullptr;
  }
  channels_.clear();
  device_ = nullptr;
  if (context_ != nullptr) iio_context_destroy(context_);
  context_ = nullptr;
}

bool IioDevice::read(std::span<std::int64_t> numbers) {
  try {
    if (buffer_ == nullptr) open();
  } catch (const ConfigError&) {
    close();
    return false;
  }
  // A starved read fails for ever after its time-out (libiio's issue 981): all is opened again.
  if (iio_buffer_refill(buffer_) <= 0) {
    close();
    return false;
  }
  const std::ptrdiff_t newest = static_cast<std::ptrdiff_t>(block_ - 1) * iio_buffer_step(buffer_);
  for (std::size_t i = 0; i < channels_.size() && i < numbers.size(); ++i) {
    const void* first = iio_buffer_first(buffer_, channels_[i]);
    numbers[i] = converted(channels_[i], static_cast<const char*>(first) + newest);
  }
  return true;
}

void IioDevice::cancel() noexcept {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  if (buffer_ != nullptr) iio_buffer_cancel(buffer_);
}

}  // namespace stillhand::runtime
