// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/recording/tally.hpp"
#include "services/recording/tape.hpp"
#include "services/recording/trial_log.hpp"
#include "services/runtime/bus/found_writer.hpp"

namespace stillhand::recording {

/// A bus on a tape, whoever listens: a channel for each writer, what came of each, and both as
/// metadata of every file, "stillhand.counts" and "stillhand.trials".  take() is for DDS's threads,
/// the rest for any.
class BusRecording {
 public:
  /// @throws ConfigError as Tape does
  explicit BusRecording(TapeOptions options);

  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);

  [[nodiscard]] Tape& tape() noexcept { return tape_; }
  [[nodiscard]] const Tape& tape() const noexcept { return tape_; }
  [[nodiscard]] const Tally& tally() const noexcept { return tally_; }
  [[nodiscard]] const TrialLog& trials() const noexcept { return trials_; }

 private:
  [[nodiscard]] std::vector<Metadata> last_words() const;

  // The tape asks both for their words as it closes a file: it is made after them and ends first.
  TrialLog trials_;
  Tally tally_;
  Tape tape_;
};

}  // namespace stillhand::recording
