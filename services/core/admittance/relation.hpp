// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/admittance/line_responses.hpp"

namespace stillhand::admittance {

/// Mismatch of the relation at one line.
struct Mismatch {
  LineResponse line;    ///< M [-], with variance and 95 % circle about it; coherence not used
  bool within = false;  ///< the circle holds 0
};
struct RelationTest {
  std::vector<Mismatch> lines;
  double share_within = 0.0;     ///< of the lines
  double median_mismatch = 0.0;  ///< |M|
  double median_radius = 0.0;    ///< of the 95 % circles: what the data could have shown
};

/// Position feedthrough = force feedthrough times deflection per force, Eq. AD-16:
///
///   M = (X/A) / (H X/F_m) - 1,   C_M = |1 + M|^2 (C_XA/|X/A|^2 + C_H/|H|^2 + C_XF/|X/F_m|^2)
///
/// from three records at the same lines: X/A with the stick free, H with the stick held, X/F_m with
/// the stick free and the lines swapped (ExcitationConfig::swapped).  Nothing is interpolated and
/// no model is used.
/// @param neighbours  nu of the record with the fewest
/// @throws stillhand::ConfigError when the lines differ.
RelationTest test_relation(const std::vector<LineResponse>& feedthrough_to_position,
                           const std::vector<LineResponse>& held_feedthrough,
                           const std::vector<LineResponse>& stick_per_force,
                           std::int64_t neighbours);

}  // namespace stillhand::admittance
