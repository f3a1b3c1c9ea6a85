// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/mitigations/cases.hpp"
#include "apps/study/mitigations/mitigated_trial.hpp"
#include "services/core/statistics/counts.hpp"
#include "services/core/statistics/ratio.hpp"

namespace stillhand::study {

struct CampaignOptions {
  std::int64_t subjects = 48;
  std::uint64_t seed = 1;
  double trial_s = 60.0;  ///< its first third does not count
  double identify_s = 120.0;
  population::Population population;
  std::vector<Condition> mitigations;  ///< B among them
  std::vector<TrialTask> tasks{kTrialTasks.begin(), kTrialTasks.end()};
  std::vector<TrialMotion> motions{kTrialMotions.begin(), kTrialMotions.end()};
  unsigned threads = 0;  ///< 0: one per core
};

/// One cell of the table.
struct CellKey {
  Condition mitigation = kB;
  ModelOf model = ModelOf::kNone;
  TrialTask task = TrialTask::kTrack;
  TrialMotion motion = TrialMotion::kBand;
};

/// What a mitigation does to people, METHOD Eqs. SU-19 and SU-20.
struct CellFigures {
  CellKey key;
  std::vector<TrialFigures> people;  ///< in their order
  std::vector<double> restored;      ///< of each person; NaN: the motion hardly disturbs this one
  double error_mm = 0.0;             ///< mean
  double motor_n = 0.0;              ///< mean of the RMS
  double effort_n = 0.0;
  std::optional<statistics::RatioInterval> restored_mean;     ///< SU-5, Fieller
  std::optional<statistics::MedianInterval> restored_median;  ///< none: nobody was disturbed
  std::optional<std::size_t> worst_person;                    ///< who got the least of `restored`
  std::size_t harmed = 0;
  statistics::ShareInterval harm;
};

struct Campaign {
  CampaignOptions options;
  std::size_t chosen_on = 0;  ///< people on whom parameters were chosen
  Chosen chosen;
  std::vector<CellFigures> cells;
  /// RMS error of each person without platform motion [task][person].
  std::vector<std::vector<double>> still_mm;
  double wall_s = 0.0;
  double processor_s = 0.0;
};

/// Reports the stage and its progress from 0 to 1.  @return false to stop early
using OnCampaign = std::function<bool(const std::string& stage, double share)>;

/// Runs the whole table: identifies the people and the others on whom parameters are chosen,
/// chooses, runs every trial.  The same options give the same numbers for any number of threads.
/// @throws ConfigError for options out of range; Interrupted
Campaign run_campaign(const CampaignOptions& options, const OnCampaign& on_stage);

/// The figures of a cell from those of all people, Eqs. SU-19 and SU-20.
/// @param none_mm, still_mm  RMS errors without a mitigation, and without motion
CellFigures cell_figures(const CellKey& key, std::vector<TrialFigures> people,
                         const std::vector<double>& none_mm, const std::vector<double>& still_mm);

}  // namespace stillhand::study
