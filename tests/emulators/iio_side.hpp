// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "services/core/rig/rig.hpp"

namespace stillhand::emulators {

/// An accelerometer and a bridge converter whose samples Debian's iiod takes from two FIFOs, in the
/// place of a kernel's buffers (tests/integration/iio_context.py: formats and scales).  A FIFO is
/// open only while somebody reads it, and emptied when a reader leaves: nothing is kept for one
/// that comes later.
class IioSide {
 public:
  IioSide(std::filesystem::path accelerometer, std::filesystem::path bridge);
  ~IioSide();
  IioSide(const IioSide&) = delete;
  IioSide& operator=(const IioSide&) = delete;

  /// One sample of each.
  void write(const rig::RawSample& raw, std::int64_t now_ns);
  struct Counts {
    std::int64_t longest_gap_ns = 0;  ///< between two samples
    std::uint64_t lost = 0;           ///< samples for which the buffer had no room
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// Nothing comes any more: a cable that was pulled out.
  void starve(bool starved) { starved_ = starved; }
  /// The accelerometer's converter is at its end.
  void saturate(bool saturated) { saturated_ = saturated; }

 private:
  struct Fifo {
    std::filesystem::path path;
    std::filesystem::path length = {};  ///< file with the samples for which the buffer has room
    int watch = -1;                     ///< of inotify
    int descriptor = -1;
  };
  void watch(Fifo& fifo) const;
  static void empty(const Fifo& fifo);
  static bool is_full(const Fifo& fifo);
  void put(Fifo& fifo, std::int32_t word);
  void empty_those_left();

  int readers_;  ///< inotify
  Fifo accelerometer_;
  Fifo bridge_;
  Counts counts_;
  std::int64_t written_ns_ = 0;
  bool starved_ = false;
  bool saturated_ = false;
};

}  // namespace stillhand::emulators
