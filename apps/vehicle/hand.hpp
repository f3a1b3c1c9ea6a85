// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "apps/vehicle/drive_loop.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/vehicle/loop_margin.hpp"

namespace stillhand::vehicle {

/// What was identified of one subject, from what the bus shows: commands and sensed signals.
/// Frequencies are the motion lines of the free stick.
struct IdentifiedHand {
  identification::FeedthroughModel model;  ///< of the pegged trial: what the canceller runs
  IdentifiedResponse
      feedthrough;               ///< Theta [rad per m/s^2]: sensed stick per commanded acceleration
  IdentifiedResponse cancelled;  ///< the same with the canceller, Eq. VH-12
  IdentifiedResponse from_pegged;  ///< the paper's route, Eq. VH-13; its variance is not known
};

/// Lengths of the identification.
struct IdentifyPlan {
  double pegged_s = 60.0;
  int periods = 6;  ///< of the free stick, of 20 s each; 4 or more
  int lines = 32;   ///< of force and of motion, 0.4 to 9 Hz
};

/// Identifies a hand: a pegged trial, then a free stick at interleaved lines.  With F [rad/N] the
/// stick per motor command, A the sensed per commanded acceleration, H the pegged model:
///
///   Theta_cancelled = Theta - F H A     (VH-12)
///   Theta_pegged    =         F H A     (VH-13)
///
/// All delays of sensing, filter and motor are in F and A.
/// @throws ConfigError when no usable model comes out.
IdentifiedHand identify_hand(const DriveConfigs& configs, std::uint64_t seed,
                             const IdentifyPlan& plan);

}  // namespace stillhand::vehicle
