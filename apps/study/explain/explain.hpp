// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/explain/inference.hpp"
#include "apps/study/explain/spread.hpp"

namespace stillhand::study {

struct ExplainOptions {
  std::size_t subjects = 32;  ///< simulated for every value of a cause
  std::uint64_t seed = 1;     ///< of them; other subjects, of seed + 1, judge
  unsigned threads = 0;       ///< 0: one per core
  double unit_mm = 5.5;       ///< of the paper's RMS error
  StudyOptions study;         ///< lengths of the trials
  bool means = true;          ///< look for causes of the means of C
  bool spread = true;         ///< look for causes of the spread of B - C

  /// Those who judge, and all of the spread.
  [[nodiscard]] std::size_t judging_subjects() const { return 3 * subjects / 2; }
};

/// A hypothesis on subjects that the inference did not see, without any linear step.
struct Judged {
  std::string name;
  Prediction tables;  ///< as simulated
  /// Log likelihood of the paper's tables there, with the log prior of the calibration over that of
  /// no change; nothing is integrated out.
  double log_score = 0.0;
  TableVector z;                     ///< against the paper, in its standard errors
  std::array<double, 3> restored{};  ///< (B - C) / (B - A) by metric
  std::vector<Response> subjects;
};

/// The best explanations under another unit of the paper's RMS error.
struct UnitSensitivity {
  double unit_mm = 0.0;
  std::string best_single;
  std::string best_pair;
  double paper_chain = 0.0;  ///< log evidence over that of no cause
  double best_pair_gain = 0.0;
};

/// Judged besides no cause and the paper's chain.
inline constexpr std::size_t kJudgedSingles = 4;
inline constexpr std::size_t kJudgedPairs = 4;

/// Everything that --explain-paper finds.
struct Explanation {
  ExplainOptions options;
  PaperTables paper;
  std::vector<Hypothesis>
      single;  ///< no cause first, then in the order of causes(); empty: not asked for
  std::vector<Hypothesis> pairs;  ///< best first
  std::vector<Judged>
      judged;  ///< no cause, the paper's chain, then the best singles, then the best pairs
  std::optional<Judged> compensated;  ///< the best explanation with today's canceller, on time
  std::vector<UnitSensitivity> units;
  std::optional<Spread> spread;
  double wall_s = 0.0;

  [[nodiscard]] const Hypothesis& find(const std::string& name) const;
  /// Single causes and pairs.
  [[nodiscard]] std::vector<Hypothesis> all() const;
  /// Of all hypotheses, the one with the largest evidence.
  [[nodiscard]] const Hypothesis& best() const;
};

/// Reports the stage and its progress from 0 to 1.  @return false to stop early
using OnStage = std::function<bool(const std::string& stage, double share)>;

/// Checks lengths and subjects of the study that both runs begin with.
/// @throws ConfigError naming what is out of range
void check_base(const ExplainOptions& options);

/// The spread alone.
Spread explain_spread(const ExplainOptions& options, const OnStage& on_stage);

/// Looks for causes of the paper's tables; README, "What explains the paper's C".
/// @throws ConfigError for options out of range; Interrupted
Explanation explain_paper(const ExplainOptions& options, const OnStage& on_stage);

}  // namespace stillhand::study
