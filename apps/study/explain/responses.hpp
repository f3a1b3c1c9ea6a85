// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "apps/study/explain/causes.hpp"
#include "apps/study/subjects/study.hpp"

namespace stillhand::study {

/// Metrics of one subject: A, B, C by RMS error [mm], dwell ratio [-], crossover [Hz].
using Metrics = std::array<double, 9>;

/// What an experiment could measure besides the tables.
struct Observed {
  double counterforce_delay_s = 0.0;    ///< C
  double cancelled_share = 0.0;         ///< C
  double feedthrough_ratio = 0.0;       ///< RMS of the feedthrough force, C over B
  double pegged_vaf_percent = 0.0;      ///< of the model on unseen pegged data
  double motor_over_feedthrough = 0.0;  ///< C, RMS of both forces
  double c_after_b = 0.0;               ///< trials from B to C, negative: before it
};

/// One subject under one set of options.
struct Response {
  Metrics metrics{};
  Observed observed;
};

/// The metrics alone.
std::vector<Metrics> metrics_of(const std::vector<Response>& responses);

/// One simulated study: its options, and how many of its subjects.
struct Setting {
  std::string label;
  StudyOptions options;
};

/// Runs the first `subjects` subjects of every setting.  Every setting sees the same subjects,
/// motion, targets and remnant, so that their differences are the settings'.
/// @return by setting, then by subject; NaN for a subject whose limbs no rig accepts
/// @throws Interrupted when on_progress returned false
std::vector<std::vector<Response>> run_settings(const std::vector<Setting>& settings,
                                                std::size_t subjects, unsigned threads,
                                                const OnProgress& on_progress);

}  // namespace stillhand::study
