// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/recorded/replay.hpp"
#include "apps/close_the_loop/verdict.hpp"
#include "apps/measurement/read.hpp"

namespace stillhand::close_the_loop {

/// The recordings that close the loop without a rig, each in any form that measurement reads.
struct RecordedOptions {
  std::vector<std::string> pegged;     ///< at least one: a_y to f with the stick held
  std::vector<std::string> moving;     ///< condition B: the stick's own equation
  std::vector<std::string> cancelled;  ///< condition C: the latency of motor and load cell
  std::vector<std::string> unseen;     ///< pegged, for judging; empty: kept apart from `pegged`
  /// Trial of each file of `pegged`, `moving` and `cancelled`, as ReadOptions::session_trial; where
  /// there is none, the last trial I, B or C.
  std::vector<std::string> pegged_trials = {}, moving_trials = {}, cancelled_trials = {};
  std::vector<std::string> inputs{"a_y"};
  std::string output = "f";
  measurement::ReadOptions read;  ///< columns of files of other programs, for all of them
  DeclaredDrive declared;
  diagnosis::ForEach for_each = diagnosis::in_order;
  std::function<bool(const std::string& step)> progress = [](const std::string&) { return true; };
};

/// What one record, which no fit has seen, keeps of its force.
struct Judged {
  std::string source;
  double seconds = 0.0;                   ///< of the record
  Remaining linear;                       ///< prediction of the linear model subtracted
  Remaining augmented;                    ///< prediction of the model with the effects subtracted
  std::optional<Remaining> motor_linear;  ///< canceller and motor run over the record
  std::optional<Remaining> motor_augmented;
};

/// Result of the loop over recordings.
struct RecordedLoop {
  std::string unit;  ///< of the output
  Verdict verdict;
  std::optional<cancellation::ControlModel> linear_control;
  std::string no_motor;            ///< why no motor was run, or empty
  std::string linear_not_carried;  ///< why it was not run with the linear model, or empty
  std::vector<Judged> judged;
  bool kept =
      true;  ///< the augmented model leaves no more on the unseen records than the linear one
  std::vector<std::string> notes;  ///< of the readers
};

/// Diagnoses the recordings, and judges the linear and the augmented model on the unseen ones:
/// README "From recordings".  An augmented model that leaves more there is not kept.
/// @throws ConfigError for a recording that cannot be used, diagnosis::Interrupted
RecordedLoop close_recorded_loop(const RecordedOptions& options);

}  // namespace stillhand::close_the_loop
