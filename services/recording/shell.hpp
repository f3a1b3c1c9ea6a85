// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "services/recording/bus_recording.hpp"
#include "services/recording/keep_options.hpp"
#include "services/runtime/service.hpp"

namespace stillhand::recording {

/// The recorder's process: every topic of the catalogue, as it came, into one MCAP file.  The
/// receiving thread only copies bytes into the tape's queue.
class Shell {
 public:
  /// @throws ConfigError as Tape does
  Shell(runtime::Service& service, const KeepOptions& keep);
  /// @throws std::runtime_error when something that was received is not in the file
  void run();

 private:
  void subscribe(const topics::Topic& topic);
  void watch();
  void see_others_out();

  runtime::Service& service_;
  std::optional<BusRecording> recording_;  // made last, so that a refusal leaves no file
  std::atomic<std::uint64_t> unattributed_{0};
};

}  // namespace stillhand::recording
