// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>
#include <unistd.h>

#include <filesystem>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "services/system/process/clock.hpp"
#include "tests/emulators/moteus_emulator.hpp"
#include "tests/emulators/serial_side.hpp"

namespace stillhand::device_rig {

/// An emulated drive behind its pseudo-terminal, in a thread of its own.
class EmulatedDrive {
 public:
  explicit EmulatedDrive(bool uart = false) : drive_(uart), serial_(link_) {
    drive_.begin(runtime::monotonic_ns());
    thread_ = std::jthread([this](const std::stop_token& stop) { answer(stop); });
  }

  [[nodiscard]] const std::filesystem::path& port() const { return link_; }
  /// Calls `use(drive, serial side)` while the thread waits.
  template <typename Use>
  auto with(Use use) {
    const std::lock_guard lock(mutex_);
    return use(drive_, serial_);
  }
  double torque_n_m() {
    return with([](auto& drive, auto&) { return drive.torque_n_m(); });
  }
  emulators::DriveRecord record() {
    return with([](auto& drive, auto&) { return drive.record(); });
  }

 private:
  void answer(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd wanted{with([](auto&, auto& serial) { return serial.descriptor(); }), POLLIN, 0};
      poll(&wanted, 1, 1);
      const std::lock_guard lock(mutex_);
      const std::int64_t now_ns = runtime::monotonic_ns();
      if (wanted.revents != 0 && serial_.descriptor() >= 0) {
        serial_.write(drive_.take(serial_.read(), now_ns), now_ns);
      }
      serial_.send_due(now_ns);
      drive_.tick(now_ns);
    }
  }

  std::filesystem::path link_ =
      std::filesystem::temp_directory_path() / ("stillhand-drive-" + std::to_string(getpid()));
  std::mutex mutex_;
  emulators::MoteusEmulator drive_;
  emulators::SerialSide serial_;
  std::jthread thread_;  // last
};

}  // namespace stillhand::device_rig
