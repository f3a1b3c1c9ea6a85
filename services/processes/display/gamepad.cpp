// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/gamepad.hpp"

#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display {

namespace {

std::optional<PadAct> act_of(const input_event& event) {
  if (event.type == EV_ABS && event.code == ABS_HAT0X && event.value != 0) {
    return event.value < 0 ? PadAct::kLeft : PadAct::kRight;
  }
  if (event.type != EV_KEY || event.value != 1) return std::nullopt;  // 0: released, 2: held
  switch (event.code) {
    case BTN_DPAD_LEFT:
    case BTN_TL:
    case BTN_THUMB:
      return PadAct::kLeft;
    case BTN_DPAD_RIGHT:
    case BTN_TR:
    case BTN_THUMB2:
      return PadAct::kRight;
    case BTN_SOUTH:
    case BTN_TRIGGER:
      return PadAct::kConfirm;
    default:
      return std::nullopt;
  }
}

}  // namespace

void PadEvents::take(std::span<const std::byte> bytes) {
  rest_.insert(rest_.end(), bytes.begin(), bytes.end());
  std::size_t done = 0;
  for (; rest_.size() - done >= sizeof(input_event); done += sizeof(input_event)) {
    input_event event{};
    std::memcpy(&event, rest_.data() + done, sizeof(event));
    if (event.type == EV_ABS && event.code == ABS_X) axis_ = event.value;
    if (const auto act = act_of(event)) acts_.push_back(*act);
  }
  rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(done));
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
    at_start_ = share_of_axis(axis.value, low_, high_);
  }
}

Gamepad::~Gamepad() { close(device_); }

void Gamepad::read_events() {
  std::array<std::byte, 64 * sizeof(input_event)> bytes{};
  for (;;) {
    const ssize_t count = read(device_, bytes.data(), bytes.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    gone_ = count <= 0;
    if (gone_) return;
    events_.take(std::span(bytes).first(static_cast<std::size_t>(count)));
  }
}

std::optional<double> Gamepad::position() {
  read_events();
  if (gone_) return std::nullopt;  // unplugged: the force on the stick fades
  const auto axis = events_.axis();
  return axis ? std::optional(share_of_axis(*axis, low_, high_)) : at_start_;
}

std::vector<PadAct> Gamepad::acts() {
  read_events();
  return events_.acts();
}

}  // namespace stillhand::display
