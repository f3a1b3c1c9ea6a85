// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand::runtime {

/// Wakes a thread that waits for a descriptor.  ring() is one system call that never waits; any
/// thread may call it.
class Bell {
 public:
  /// @throws std::system_error if the system has no descriptor left
  Bell();
  ~Bell();
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  void ring() noexcept;
  /// Waits until it rings or `descriptor` has something to read, at most `most_ms`; takes the
  /// ringing back.  @param descriptor  -1: none
  void wait(int descriptor, int most_ms) noexcept;

 private:
  int descriptor_;
};

}  // namespace stillhand::runtime
