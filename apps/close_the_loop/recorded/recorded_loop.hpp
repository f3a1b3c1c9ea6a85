// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/recorded/decision.hpp"
#include "apps/close_the_loop/verdict/verdict.hpp"
#include "apps/libraries/measurement/read.hpp"

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
  /// Inputs, output and the rest of the body's diagnosis, as `stillhand diagnose` takes them.
  diagnosis::DiagnoseOptions diagnose;
  measurement::ReadOptions read;  ///< columns of files of other programs, for all of them
  DeclaredDrive declared;
  std::function<bool(const std::string& step)> progress = [](const std::string&) { return true; };
};

/// Result of the loop over recordings.
struct RecordedLoop {
  std::string unit;  ///< of the output
  Verdict verdict;
  std::optional<cancellation::ControlModel> linear_control;
  std::string no_motor;            ///< why no motor was run, or empty
  std::string linear_not_carried;  ///< why it was not run with the linear model, or empty
  std::vector<Judged> judged;
  Decision decision;               ///< which model is kept
  std::vector<std::string> notes;  ///< of the readers
};

/// Diagnoses the recordings, and judges the linear and the augmented model on the unseen ones:
/// README "From recordings".  An augmented model with which the motor leaves more there is not
/// kept.
/// @throws ConfigError for a recording that cannot be used, diagnosis::Interrupted
RecordedLoop close_recorded_loop(const RecordedOptions& options);

}  // namespace stillhand::close_the_loop
