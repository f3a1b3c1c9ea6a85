// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "services/core/device_rig/joystick_record.hpp"
#include "services/system/transport/port.hpp"

namespace stillhand::device_rig {

/// A joystick of evdev with FF_CONSTANT, for this process alone (EVIOCGRAB).  Each write is a
/// ForceRecord and is answered by a StickRecord.  Every force has a length, so that the kernel or
/// the device ends it if this process dies.  One thread.
class JoystickPort final : public runtime::Port {
 public:
  /// @param path  /dev/input/by-id/...-event-joystick
  /// @throws ConfigError if it is no such joystick, or another process has it
  explicit JoystickPort(const std::string& path);
  ~JoystickPort() override;

  [[nodiscard]] int descriptor() const noexcept override { return answered_; }
  std::string_view read(std::span<char> into) noexcept override;
  bool write(std::string_view bytes) noexcept override;
  [[nodiscard]] bool gone() const noexcept override { return gone_; }

 private:
  void open(const std::string& path);
  void close() noexcept;
  bool play(const ForceRecord& record) noexcept;
  bool send(std::uint16_t code, std::int32_t value) noexcept;

  int descriptor_ = -1;
  int answered_ = -1;  ///< an eventfd: an answer is there
  std::int16_t effect_ = -1;
  ForceLatch latch_;
  bool refused_ = false;
  bool gone_ = false;
};

}  // namespace stillhand::device_rig
