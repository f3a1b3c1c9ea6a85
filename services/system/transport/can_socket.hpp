// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "services/system/process/host_lock.hpp"
#include "services/system/transport/port.hpp"

namespace stillhand::runtime {

/// A CAN interface of the kernel with CAN-FD frames.  Each read and each write is one
/// `struct canfd_frame` (or `can_frame`); a frame is taken as a whole or not at all.  One thread.
class CanSocket final : public Port {
 public:
  /// @param interface  "can0"
  /// @throws ConfigError if the kernel has no CAN, the interface is missing, down or without
  ///         CAN-FD, or another process of Stillhand has it
  explicit CanSocket(const std::string& interface);
  ~CanSocket() override;

  [[nodiscard]] int descriptor() const noexcept override { return descriptor_; }
  std::string_view read(std::span<char> into) noexcept override;
  bool write(std::string_view bytes) noexcept override;
  [[nodiscard]] bool gone() const noexcept override { return gone_; }

 private:
  void open(const std::string& interface);
  void close() noexcept;

  int descriptor_ = -1;
  std::optional<HostLock> lock_;
  bool gone_ = false;
};

}  // namespace stillhand::runtime
