// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "services/bus/recording/bus_recording.hpp"
#include "services/bus/recording/keep_options.hpp"
#include "services/bus/recording/of_experiment.hpp"
#include "services/bus/service.hpp"

namespace stillhand::recording {

/// The process of the recorder: it writes every topic of the catalogue, unchanged, into one MCAP
/// file.  The receiving thread only copies bytes into the queue of the tape.
class Shell {
 public:
  /// @throws ConfigError like Tape
  Shell(runtime::Service& service, const KeepOptions& keep, const OfExperiment& place);
  /// @throws std::runtime_error if a received message is not in the file
  void run();

 private:
  void subscribe(const topics::Topic& topic);
  void report_file();
  void watch();
  void keep_trial();
  void see_others_out();

  runtime::Service& service_;
  std::optional<BusRecording> recording_;  // constructed last, so a refusal leaves no file
  std::atomic<std::uint64_t> unattributed_{0};
  bool reported_file_ = false;      // receiving thread only
  std::atomic<Tick> end_tick_{-1};  ///< of the newest trial, ramps included; -1: none yet
  std::atomic<Tick> rig_tick_{-1};
  Tick kept_tick_ = -1;  ///< the end of the newest trial that is on the disk
};

}  // namespace stillhand::recording
