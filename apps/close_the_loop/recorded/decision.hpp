// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/recorded/replay.hpp"
#include "apps/close_the_loop/verdict/gain.hpp"

namespace stillhand::close_the_loop {

/// What one record, which no fit has seen, keeps of its force.
struct Judged {
  std::string source;
  double seconds = 0.0;                   ///< of the record
  Remaining linear;                       ///< prediction of the linear model subtracted
  Remaining augmented;                    ///< prediction of the model with the effects subtracted
  std::optional<Remaining> motor_linear;  ///< canceller and motor run over the record (C)
  std::optional<Remaining> motor_augmented;  ///< the same samples (C+)
};

/// Which model the loop keeps, METHOD Eq. CL-9.  It is computed from the rows that are shown, so
/// that a model that leaves more is not kept.
struct Decision {
  bool by_motor = true;  ///< else by the prediction
  bool same = false;     ///< nothing is added: C+ is C
  /// Over all unseen records: `without` is what C leaves, `left` what C+ leaves.  None where C+ did
  /// not run.
  std::optional<Remaining> step;
  std::vector<std::string> worse;  ///< records on which C+ leaves more for certain
  bool helps = true;  ///< what is kept leaves less than no motor, or no prediction, does

  [[nodiscard]] bool kept() const {
    return same || (step && is_gain(step->cut(), step->cut_interval95()));
  }
};

/// @param judged     at least one record
/// @param same       the augmented model is the linear one
/// @param motor_may  the canceller reads the inputs and gives the output
/// @param plus_runs  it takes the augmented model
Decision decide(const std::vector<Judged>& judged, bool same, bool motor_may, bool plus_runs);

}  // namespace stillhand::close_the_loop
