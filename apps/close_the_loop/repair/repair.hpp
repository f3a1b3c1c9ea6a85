// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/repair/person_loop.hpp"
#include "apps/close_the_loop/session/closed_loop.hpp"
#include "apps/close_the_loop/session/conditions.hpp"

namespace stillhand::close_the_loop {

/// What an effect costs, and what is gained if it is mended or cancelled, METHOD Eq. CL-11 to
/// CL-13.  Of the RMS tracking error, predicted by the person's own model.
struct Worth {
  std::string kind;
  std::string channel;  ///< empty: none
  std::string where;
  std::string why_not;        ///< there is no prediction; empty: there is
  bool is_cancelled = true;   ///< C+ does something about it
  Estimate left_mm;           ///< as in C'
  Estimate cancelled_mm;      ///< by C+
  Estimate mended_mm;         ///< the rig or the person is without it
  Estimate by_mending_mm;     ///< change from left to mended, seed by seed
  Estimate by_cancelling_mm;  ///< from left to C+

  /// "leave" if neither change is below 0 by its whole interval, "mend" if only that one is, or if
  /// it gains more than cancelling by more than the interval of its own; else "cancel".
  [[nodiscard]] const char* advice() const;
};

/// The repair list of a session.
struct RepairList {
  std::vector<Worth> effects;  ///< what mending is worth, the most first
  double modelled_mm = 0.0;    ///< C' as the person's model has it
  double measured_mm = 0.0;    ///< C' as it was measured
};

/// Of the trials' recordings and the verdict alone.
RepairList repair_list(const LoopResult& result, const LoopOptions& options);

}  // namespace stillhand::close_the_loop
