// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/experiment/folder/folder.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/identification/tracking_metrics.hpp"
#include "services/core/recording/recording.hpp"

/// What an experiment's folder holds, for an export: facts of the plan, the journals and the
/// recordings.  Free text of a person (reasons, notes) and times of day are left out here, so no
/// form of an export can have them.
namespace stillhand::experiment {

enum class TrialKind : std::uint8_t {
  kIdentification,
  kFreeIdentification,  ///< of the feedthrough to position, where a condition needs it
  kPractice,
  kTracking
};
/// "identification", "freestick", "practice", "tracking".
const char* name_of(TrialKind kind);

/// Condition of a trial in which the motor ran another model than the condition's.
inline constexpr const char* kOtherModel = "n/a";

/// One trial that was recorded, complete or not.
struct ExportedTrial {
  std::int64_t session = 1;
  TrialKind kind = TrialKind::kTracking;
  Trial trial;              ///< number and measured ticks as planned
  Tick end_tick = 0;        ///< first tick after it; earlier than planned if it was ended early
  std::int64_t block = 0;   ///< from 1; 0: none
  std::int64_t place = 0;   ///< in the plan, from 1; 0: none
  std::string condition;    ///< "A" to "C+", or kOtherModel; empty: identification
  bool completed = false;   ///< by the journal
  double lost_share = 0.0;  ///< [-] of the planned samples
  std::optional<identification::TrackingMetrics> metrics;  ///< of a complete tracking trial
};

/// The answer to one question of experiment.yaml.
struct ExportedAnswer {
  std::int64_t session = 1;
  std::int64_t block = 0;
  std::string question;
  std::int64_t answer = 0;
};

struct ExportedParticipant {
  std::size_t index = 0;
  std::string code;  ///< "P07"
  bool excluded = false;
  bool simulated = false;              ///< no person
  std::vector<std::int64_t> sessions;  ///< those with a recording
  std::vector<ExportedTrial> trials;   ///< by session, then number
  std::vector<ExportedAnswer> answers;
};

struct DataSet {
  std::vector<ExportedParticipant> participants;
  std::string released;  ///< "2026-11-25": the day on which the experiment was unblinded
};

/// Reports progress.  @return false to stop
using OnSession = std::function<bool(std::int64_t done, std::int64_t all)>;

/// Reads plans, journals and recordings.
/// @throws ConfigError for a blinded experiment, for anything that Folder::findings() names, for a
///         trial that the journal does not know or whose recorded condition is another one, and if
///         nobody has a recorded trial; study::Interrupted
DataSet data_set_of(const Folder& folder, const OnSession& on_session);

/// The measured samples of one trial at 1 kHz, one row a tick until its end: `time_s` from 0, the
/// columns of the CSV format (services/processes/recording/README.md).  A value that was lost is
/// NaN.
/// @throws ConfigError for a trial without two samples
recording::Recording rows_of(const Folder& folder, const ExportedParticipant& participant,
                             const ExportedTrial& trial);

}  // namespace stillhand::experiment
