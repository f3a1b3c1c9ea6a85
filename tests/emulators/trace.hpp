// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <vector>

namespace stillhand::emulators {

/// What an answer of the drive carried.
struct TracedReply {
  std::int64_t sampled_ns;  ///< when the sensors gave these numbers
  std::int64_t sent_ns;     ///< after the answer was written
  double analog1, analog2, position_rev;
};

/// Times at which samples left the emulated drive and torques began, in its own clock, kept in
/// memory until they are written (tests/benchmark/device_latency.py).
class Trace {
 public:
  void begin() {
    constexpr std::size_t kMost = 400'000;  // of 1 kHz: no allocation for six minutes
    replies_.reserve(kMost);
    torques_.reserve(kMost);
    on_ = true;
  }
  void reply(const TracedReply& reply) {
    if (on_) replies_.push_back(reply);
  }
  void torque(std::int64_t at_ns, double torque_n_m) {
    if (on_) torques_.push_back({at_ns, torque_n_m});
  }
  /// FILE_replies.csv and FILE_torques.csv, every digit.
  void write(const std::filesystem::path& file) const {
    std::ofstream replies(file.string() + "_replies.csv");
    replies << std::setprecision(17) << "sampled_ns,sent_ns,analog1,analog2,position_rev\n";
    for (const TracedReply& each : replies_) {
      replies << each.sampled_ns << ',' << each.sent_ns << ',' << each.analog1 << ','
              << each.analog2 << ',' << each.position_rev << '\n';
    }
    std::ofstream torques(file.string() + "_torques.csv");
    torques << std::setprecision(17) << "at_ns,torque_n_m\n";
    for (const Torque& each : torques_) torques << each.at_ns << ',' << each.torque_n_m << '\n';
  }

 private:
  struct Torque {
    std::int64_t at_ns;
    double torque_n_m;
  };
  std::vector<TracedReply> replies_;
  std::vector<Torque> torques_;
  bool on_ = false;
};

}  // namespace stillhand::emulators
