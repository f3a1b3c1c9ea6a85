// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/bus/found_writer.hpp"
#include "services/bus/recording/tally.hpp"
#include "services/bus/recording/tape.hpp"
#include "services/bus/recording/trial_log.hpp"

namespace stillhand::recording {

/// Records a bus on a tape: a channel for each writer, the counts of each writer, and the trials.
/// Every file contains the metadata "stillhand.counts" and "stillhand.trials".  The threads of DDS
/// call take(); any thread may call the other functions.
class BusRecording {
 public:
  /// @throws ConfigError like Tape
  explicit BusRecording(TapeOptions options);

  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);
  void end_instance(std::size_t writer, std::int64_t sequence) {
    tally_.end_instance(writer, sequence);
  }

  [[nodiscard]] Tape& tape() noexcept { return tape_; }
  [[nodiscard]] const Tape& tape() const noexcept { return tape_; }
  [[nodiscard]] const Tally& tally() const noexcept { return tally_; }
  [[nodiscard]] const TrialLog& trials() const noexcept { return trials_; }

 private:
  [[nodiscard]] std::vector<Metadata> last_words() const;

  // The tape reads both when it closes a file, so it is constructed after them and destroyed first.
  TrialLog trials_;
  Tally tally_;
  Tape tape_;
};

}  // namespace stillhand::recording
