// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "apps/vehicle/hand.hpp"

namespace stillhand::vehicle {

/// Settings of a map of the stable region.
struct RegionOptions {
  std::string preset = "wheelchair";
  std::vector<double> delays_s{0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4};
  std::vector<double> gains_m_s2_rad;  ///< rise; empty: geometric_gains()
  std::int64_t subjects = 6;
  std::uint64_t seed = 1;
  double drive_s = 20.0;
  IdentifyPlan identify;
  unsigned threads = 0;  ///< 0: one per core
};

/// 17 gains from 4 to 100 m/s^2 per rad, each 1.22 times the one before.
std::vector<double> geometric_gains();

/// One drive and where it stands.
struct Drive {
  std::int64_t subject = 0;
  bool cancel = false;
  double delay_s = 0.0;
  double gain_m_s2_rad = 0.0;
  DriveOutcome outcome;
};

/// The limit of one subject at one delay, with or without cancellation.
struct Limit {
  std::int64_t subject = 0;
  bool cancel = false;
  double delay_s = 0.0;
  GainInterval predicted{};  ///< Eqs. VH-9, VH-11
  double predicted_hz = 0.0;
  double pegged_m_s2_rad = 0.0;  ///< the paper's route, without cancellation; otherwise 0
  double stable_m_s2_rad = 0.0;  ///< largest gain below which no drive was ended; 0: none
  double ended_m_s2_rad = 0.0;   ///< smallest gain of a drive that was ended; infinite: none
};

struct Region {
  std::vector<Drive> runs;
  std::vector<Limit> limits;
};

/// Identifies each subject, predicts the limits, and drives the whole grid of gain and delay, with
/// and without cancellation.  The same options give the same results for any number of threads.
/// @param progress  step and share done; false stops, and an empty region is returned
/// @throws ConfigError for options out of range or a hand without a usable model.
Region map_region(const RegionOptions& options,
                  const std::function<bool(const char* step, double done)>& progress);

/// How prediction and runs agree, over the limits that both have inside the grid.
struct Agreement {
  int limits = 0;       ///< compared
  int beyond = 0;       ///< no drive was ended within the grid, and none was predicted to be
  int never_ended = 0;  ///< predicted within the grid, and no drive was ended
  int at_once = 0;      ///< the first gain's drive was ended: no step to compare with
  int within = 0;       ///< the interval of the prediction meets the step of the grid at the limit
  double median = 0.0;  ///< predicted over run, geometric middle of the step
  double least = 0.0;
  double most = 0.0;
};
Agreement agreement(const std::vector<Limit>& limits, bool cancel);

/// What the detector did.
struct Stops {
  int drives = 0;
  int ended = 0;
  int well_below = 0;        ///< drives at less than 0.7 of the predicted critical gain
  int well_below_ended = 0;  ///< of these, ended: false alarms
  double well_below_minutes = 0.0;
  double median_periods = 0.0;    ///< from the floor to the end
  double share_within_two = 0.0;  ///< of the ended drives, ended within two periods of the floor
  double most_periods_from_ceiling = 0.0;
  double longest_rest_s = 0.0;    ///< from the end to a platform at rest
  double longest_motor_s = 0.0;   ///< from the end to a motor force of 0
  double largest_rad = 0.0;       ///< |theta| of any drive
  double largest_left_rad = 0.0;  ///< RMS of the last 5 s of a drive that was not ended
};
Stops stops(const Region& region);

}  // namespace stillhand::vehicle
