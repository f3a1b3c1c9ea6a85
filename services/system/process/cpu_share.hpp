// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand::runtime {

/// Share of a second's worth of something that was used, over the last whole second.  Pure.
class ShareMeter {
 public:
  /// @param used   amount used so far
  /// @param whole  amount available so far, in the same unit
  /// @param least  of `whole` that makes a new value
  /// @return the newest share; NaN before the first
  double step(std::int64_t used, std::int64_t whole, std::int64_t least) noexcept;

 private:
  bool begun_ = false;
  std::int64_t used_ = 0, whole_ = 0;
  double share_ = 0.0;
};

/// Share of one processor that this process takes.  One thread.
class ProcessCpu {
 public:
  /// @return over the last second or more, 0 to the number of processors; NaN before the first
  double step() noexcept;

 private:
  ShareMeter meter_;
};

/// Share of all processors of this host that are busy, from /proc/stat.  One thread.
class HostCpu {
 public:
  /// @return over the last second or more, 0 to 1; NaN before the first, and if /proc/stat cannot
  /// be read
  double step();

 private:
  ShareMeter meter_;
};

}  // namespace stillhand::runtime
