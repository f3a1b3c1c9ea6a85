// SPDX-License-Identifier: Apache-2.0
#include "services/display/gamepad.hpp"

#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "services/contract/config_error.hpp"

namespace stillhand::display {

std::optional<std::int32_t> AxisEvents::take(std::span<const std::byte> bytes) {
  rest_.insert(rest_.end(), bytes.begin(), bytes.end());
  std::optional<std::int32_t> newest;
  std::size_t done = 0;
  for (; rest_.size() - done >= sizeof(input_event); done += sizeof(input_event)) {
    input_event event{};
    std::memcpy(&event, rest_.data() + done, sizeof(event));
    if (event.type == EV_ABS && event.code == ABS_X) newest = event.value;
  }
  rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(done));
  return newest;
}

double share_of_axis(std::int32_t value, std::int32_t low, std::int32_t high) {
  const double half = 0.5 * (static_cast<double>(high) - low);
  return std::clamp((static_cast<double>(value) - low) / half - 1.0, -1.0, 1.0);
}

Gamepad::Gamepad(const std::filesystem::path& device)
    : device_(open(device.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (device_ < 0) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): before any other thread
    throw ConfigError("--gamepad", device.string() + ": " + std::strerror(errno),
                      "a device such as /dev/input/event5 that this user may read");
  }
  input_absinfo axis{};
  if (ioctl(device_, EVIOCGABS(ABS_X), &axis) == 0 && axis.minimum < axis.maximum) {
    low_ = axis.minimum;
    high_ = axis.maximum;
    newest_ = share_of_axis(axis.value, low_, high_);
  }
}

Gamepad::~Gamepad() { close(device_); }

std::optional<double> Gamepad::position() {
  std::array<std::byte, 64 * sizeof(input_event)> bytes{};
  for (;;) {
    const ssize_t count = read(device_, bytes.data(), bytes.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return newest_;
    if (count <= 0) {  // unplugged: the force on the stick fades
      newest_.reset();
      return newest_;
    }
    const auto value = events_.take(std::span(bytes).first(static_cast<std::size_t>(count)));
    if (value) newest_ = share_of_axis(*value, low_, high_);
  }
}

}  // namespace stillhand::display
