// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/joystick_port.hpp"

#include <fcntl.h>
#include <linux/input.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cmath>
#include <system_error>

#include "services/core/contract/config_error.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::device_rig {
namespace {

// The direction from which the force comes: 0x4000 is from the left, so that + is to the right
// (Linux, Documentation/input/ff.rst).
constexpr std::uint16_t kFromLeft = 0x4000;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw ConfigError("joystick " + path, why,
                    "an event device with FF_CONSTANT and ABS_X that this user may read and write");
}

std::string error_text() { return std::generic_category().message(errno); }

bool plays_constant_forces(int descriptor) {
  std::array<unsigned long, FF_MAX / (CHAR_BIT * sizeof(unsigned long)) + 1> bits{};
  if (ioctl(descriptor, EVIOCGBIT(EV_FF, sizeof(bits)), bits.data()) < 0) return false;
  constexpr std::size_t kWord = CHAR_BIT * sizeof(unsigned long);
  return (bits[FF_CONSTANT / kWord] >> (FF_CONSTANT % kWord) & 1u) != 0;
}

}  // namespace

JoystickPort::JoystickPort(const std::string& path) {
  try {
    open(path);
  } catch (...) {
    close();
    throw;
  }
}

JoystickPort::~JoystickPort() { close(); }

void JoystickPort::open(const std::string& path) {
  descriptor_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) refuse(path, error_text());
  input_absinfo axis{};
  if (!plays_constant_forces(descriptor_) || ioctl(descriptor_, EVIOCGABS(ABS_X), &axis) < 0) {
    refuse(path, "no joystick that plays constant forces");
  }
  if (ioctl(descriptor_, EVIOCGRAB, 1) != 0) refuse(path, "a joystick that another process has");
  answered_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (answered_ < 0) refuse(path, error_text());
  // Whole: not every joystick has a gain of its own, so each level is scaled before (DR-35).
  constexpr std::int32_t kWhole = 65535;
  send(FF_GAIN, kWhole);
  // Its own spring would be a force that nobody commands; some joysticks have none to switch off.
  send(FF_AUTOCENTER, 0);
  gone_ = false;
}

// The kernel erases the effects of a descriptor that is closed.
void JoystickPort::close() noexcept {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (answered_ >= 0) ::close(answered_);
  descriptor_ = answered_ = -1;
}

bool JoystickPort::send(std::uint16_t code, std::int32_t value) noexcept {
  input_event event{};
  event.type = EV_FF;
  event.code = code;
  event.value = value;
  if (::write(descriptor_, &event, sizeof(event)) == sizeof(event)) return true;
  gone_ = gone_ || errno == ENODEV;
  return false;
}

bool JoystickPort::play(const ForceRecord& record) noexcept {
  ff_effect effect{};
  effect.type = FF_CONSTANT;
  effect.id = effect_;
  effect.direction = kFromLeft;
  effect.u.constant.level = record.level;
  effect.replay.length = record.length_ms;
  if (ioctl(descriptor_, EVIOCSFF, &effect) < 0) {
    gone_ = gone_ || errno == ENODEV;
    return false;
  }
  effect_ = effect.id;
  return send(static_cast<std::uint16_t>(effect_), 1);
}

bool JoystickPort::write(std::string_view bytes) noexcept {
  const auto record = record_in<ForceRecord>(bytes);
  if (!record) return false;
  if (record->kind == ForceRecord::kPlay && record->length_ms > 0) {
    if (latch_.play(runtime::monotonic_ns(), record->length_ms)) refused_ = !play(*record);
  } else if (record->kind == ForceRecord::kStop) {
    latch_.stop();
    refused_ = false;
    if (effect_ >= 0) send(static_cast<std::uint16_t>(effect_), 0);
  }
  const std::uint64_t one = 1;
  return ::write(answered_, &one, sizeof(one)) == sizeof(one);
}

std::string_view JoystickPort::read(std::span<char> into) noexcept {
  std::uint64_t asked = 0;
  if (::read(answered_, &asked, sizeof(asked)) != sizeof(asked)) return {};
  // Its events say nothing that the state does not; left alone, they would fill the queue.
  std::array<input_event, 64> events{};
  if (::read(descriptor_, events.data(), sizeof(events)) < 0 && errno == ENODEV) gone_ = true;
  input_absinfo axis{};
  if (ioctl(descriptor_, EVIOCGABS(ABS_X), &axis) < 0) gone_ = true;
  if (gone_ || into.size() < sizeof(StickRecord)) return {};
  const std::int64_t now_ns = runtime::monotonic_ns();
  StickRecord record{.value = axis.value, .lowest = axis.minimum, .highest = axis.maximum};
  record.milliseconds = static_cast<std::uint32_t>(now_ns / 1'000'000);
  if (latch_.ran_out(now_ns)) {
    record.mode = StickRecord::kRanOut;
  } else if (refused_) {
    record.mode = StickRecord::kRefused;
  } else if (latch_.plays()) {
    record.mode = StickRecord::kPlays;
  }
  std::memcpy(into.data(), &record, sizeof(record));
  return {into.data(), sizeof(record)};
}

}  // namespace stillhand::device_rig
