// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/libraries/session/in_process.hpp"
#include "apps/study/subjects/conditions.hpp"
#include "apps/study/subjects/personal_spread.hpp"
#include "services/core/identification/arx.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/identification/output_error.hpp"
#include "services/core/identification/rate_conversion.hpp"
#include "services/core/population/population.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::study {

/// Options of a study.
struct StudyOptions {
  std::int64_t subjects = 12;
  std::uint64_t seed = 1;
  session::ProtocolOptions protocol;  ///< conditions and lengths; the seed is set for each subject
  population::Population population;
  double damped_stick_n_s_m = 20.0;       ///< condition E, added to the stick's own
  double arm_rest_stiffness_n_m = 500.0;  ///< condition F
  double arm_rest_damping_n_s_m = 30.0;   ///< condition F
  bool wrong_models = false;              ///< run C again with models of other subjects
  std::uint64_t undeclared_effect = 0;    ///< seed of an effect that only the rigs hold; 0: none
  rig::MotorConfig motor;                 ///< of every rig: its delay and gain
  std::string canceller = "now";          ///< cancellation::sampling_named()
  /// What else differs within and between people.  With it every trial has a rig of its own.
  std::optional<PersonalSpread> personal;
  unsigned threads = 0;  ///< 0: one per core
};

/// True for the population and the lengths of trials with which conditions A and B were calibrated.
bool is_calibrated(const StudyOptions& options);

/// The pegged trial's outcome, paper III-A and IV-A.
struct Identification {
  identification::ArxFit paper;            ///< Eqs 3 to 5
  identification::OutputErrorFit refined;  ///< the same model fitted on its free-run error
  identification::ArxFactor factor;        ///< for pooled fits
  signal::TransferEstimate estimate;       ///< Fig. 4's dots, 0 to 25 Hz
  signal::DifferenceModel fit;             ///< at 50 Hz, what `control` was made of
  identification::RateConversion control;  ///< the filter of the canceller
  std::string paper_unusable;              ///< why the refined model is used; empty: it is not
};

/// The parts of a tracking trial that the report shows.  Moving averages once a second; share and
/// delay are 0 without a motor.
struct TrackedTrial : session::TrialNumbers {
  double feedthrough_rms_n = 0.0;
  double motor_rms_n = 0.0;
  std::vector<double> target_m;  ///< 20 s from the middle, 20 Hz
  std::vector<double> cursor_m;
  /// X_p/X_r at the lines, of the mean of several trials (Eq. SU-14); empty: that of the gains.
  std::vector<std::complex<double>> closed_loop;
};

/// Everything of one subject.
struct SubjectResult {
  population::Subject subject;
  Identification identification;
  std::map<Condition, TrackedTrial> trials;  ///< by condition
  std::vector<Condition> order;              ///< order in which the conditions were run
  std::map<char, TrackedTrial> wrong;  ///< 'O' another subject's model, 'M' the mean of all others'
};

/// The undeclared effect of this study's rigs: the same for every subject, sized against the mean
/// subject.
rig::SealedEffect sealed_effect(const StudyOptions& options);

/// Checks subject `index`: draws it and makes its rig for every condition.
/// @throws ConfigError "population" with the subject's number and the value out of range.
void check_subject(const StudyOptions& options, std::int64_t index);

/// Runs subject `index`: pegged trial, identification, every condition in shuffled order.  The
/// numbers do not depend on other subjects.  @throws ConfigError when no usable model results.
SubjectResult run_subject(const StudyOptions& options, std::int64_t index);

/// Runs condition C, which the options contain, with another model at the same motion and target.
TrackedTrial run_with_model(const StudyOptions& options, const SubjectResult& result,
                            std::int64_t index, const identification::FeedthroughModel& model);

/// The model with which the subject's condition C ran, at both of its rates.
identification::FeedthroughModel used_model(const Identification& identification);

}  // namespace stillhand::study
