// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "services/rig/core/rig.hpp"

namespace stillhand::emulators {

/// An accelerometer and a bridge converter whose samples Debian's iiod takes from two FIFOs, in the
/// place of a kernel's buffers (tests/integration/iio_context.py: formats and scales).  A FIFO is
/// open only while somebody reads it: nothing is kept for a reader that comes later.
class IioSide {
 public:
  IioSide(std::filesystem::path accelerometer, std::filesystem::path bridge);
  ~IioSide();
  IioSide(const IioSide&) = delete;
  IioSide& operator=(const IioSide&) = delete;

  /// One sample of each.
  void write(const rig::RawSample& raw);
  /// Nothing comes any more: a cable that was pulled out.
  void starve(bool starved) { starved_ = starved; }
  /// The accelerometer's converter is at its end.
  void saturate(bool saturated) { saturated_ = saturated; }

 private:
  struct Fifo {
    std::filesystem::path path;
    int descriptor = -1;
  };
  static void put(Fifo& fifo, std::int32_t word);

  Fifo accelerometer_;
  Fifo bridge_;
  bool starved_ = false;
  bool saturated_ = false;
};

}  // namespace stillhand::emulators
