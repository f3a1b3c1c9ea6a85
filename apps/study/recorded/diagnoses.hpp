// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/recorded/recorded_loop.hpp"
#include "apps/study/recorded/find_sessions.hpp"
#include "apps/study/recorded/recorded_trial.hpp"
#include "apps/study/subjects/study.hpp"
#include "services/core/statistics/t_test.hpp"

namespace stillhand::study {

/// What the model lacks in one person, and what C+ would have gained.
struct PersonDiagnosis {
  std::string verdict;  ///< "nothing missing", "effects found", "unexplained residual"
  std::vector<close_the_loop::Finding> findings;  ///< that count, strongest first
  /// The motion of pegged samples that no fit saw, through canceller and motor.
  std::optional<close_the_loop::Remaining> by_linear;     ///< with the linear model, as in C
  std::optional<close_the_loop::Remaining> by_augmented;  ///< as in C+
  double detectable_body_n = 0.0;   ///< [N] RMS from which a verdict could name a further effect
  double detectable_drive_n = 0.0;  ///< [N] the same in the drive
  double unseen_s = 0.0;            ///< [s] length of those samples
  std::string not_replayed;         ///< why there is no C+ to compare, or empty

  /// [N] RMS force that C+ would have left less than C; none without both.
  [[nodiscard]] std::optional<double> gain_n() const;
};

/// Whose an effect is, by the people in whom it was found; METHOD Eq. SU-21.
enum class Whose {
  kRig,     ///< more than half of all people would have it
  kPerson,  ///< too few have it for one that everybody has
  kOpen,    ///< these people do not decide it
};

/// One kind of effect over people.
struct RecurringEffect {
  std::string kind;
  std::string channel;  ///< empty: none
  std::string where;    ///< body, drive, motor path, load cell
  std::vector<std::string> participants;
  double explained_n = 0.0;  ///< [N] median RMS force over these participants
  std::size_t able = 0;      ///< people in whom an effect of that size could be named
  Whose whose = Whose::kOpen;
};

/// The diagnoses of a recorded study.
struct Diagnoses {
  std::map<std::string, PersonDiagnosis> people;  ///< by code
  std::map<std::string, std::string> failed;      ///< by code: why there is no diagnosis
  std::vector<RecurringEffect> recurring;         ///< by the number of people, then of their force
  /// Force left by C+ less that by C, over the people with both; none for fewer than two of them,
  /// or without variance.
  std::optional<statistics::TTest> gain;
};

/// Diagnoses each participant in the tables as `stillhand close-the-loop --pegged` does: all
/// complete pegged trials, and the last complete trials of B and of C (without C: of C' or C+).
/// The last pegged trial of several, otherwise the last 30 % of it, judges and is not fitted.
/// Participants run in parallel; the results do not depend on the threads.
/// @param files    find_sessions()
/// @param threads  0: one per core
/// @throws Interrupted when on_progress returned false
Diagnoses diagnose_people(const std::vector<SessionFile>& files, const RecordedSource& source,
                          unsigned threads, const OnProgress& on_progress);

/// Effects over people: one entry for each kind, channel and place.  Pure.
std::vector<RecurringEffect> recurring_in(const std::map<std::string, PersonDiagnosis>& people);

}  // namespace stillhand::study
