// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/recorded/recorded_trial.hpp"
#include "apps/study/subjects/analysis.hpp"
#include "apps/study/subjects/study.hpp"

namespace stillhand::study {

/// One condition and metric of the same people, recorded and simulated: recorded - simulated.
struct PairedCheck {
  Condition condition = kA;
  std::size_t metric = 0;  ///< index of session::kMetrics
  std::size_t n = 0;       ///< people in whom both were found
  double mean_difference = 0.0;
  std::optional<statistics::TTest> test = {};  ///< none for one person, or without variance
  std::optional<double> p_holm = {};           ///< of the t-tests, over all conditions and metrics
  double p_signed_rank = 1.0;                  ///< Wilcoxon's, two-sided
};

/// Simulated subjects next to recorded people.
struct SimulatedSide {
  bool same_people = false;  ///< the simulated participants of an experiment, person by person
  std::uint64_t seed = 0;    ///< of the subjects
  std::vector<std::string> participants;  ///< whose entry of `results` it is; empty for others
  std::vector<SubjectResult> results;
  Analysis analysis;
  std::map<std::string, std::string> failed;  ///< by code: why a person was not simulated
  std::vector<PairedCheck> paired;            ///< of the same people alone
  /// Differences with p_holm below this level are more than chance.
  static constexpr double kAlpha = 0.05;
  [[nodiscard]] std::size_t more_than_chance() const;
};

/// Simulates the participants in the tables once more, in one process: the bodies, motions, targets
/// and remnants of an experiment with `operator: simulated`, trial by trial as recorded; the means
/// are over the same trials as those of the tables.  Trials that were not complete and practice do
/// not run.  Participants run in parallel; the results do not depend on the threads.
/// @throws Interrupted when on_progress returned false
SimulatedSide simulate_people(const RecordedSource& source, unsigned threads,
                              const OnProgress& on_progress);

/// As many subjects of the population as participants, with the conditions A, B, C of the record.
/// @param options  population, lengths and conditions of the trials, number of subjects
SimulatedSide simulate_population(const StudyOptions& options, const OnProgress& on_progress);

/// Recorded - simulated, person by person: METHOD Eq. SU-15.  Pure.
/// @param participants  of `recorded`
std::vector<PairedCheck> paired_checks(const std::vector<std::string>& participants,
                                       const Analysis& recorded,
                                       const std::vector<std::string>& simulated_participants,
                                       const Analysis& simulated);

}  // namespace stillhand::study
