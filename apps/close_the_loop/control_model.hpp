// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/cancellation/core/control_model.hpp"
#include "services/diagnosis/core/model/model.hpp"
#include "services/diagnosis/core/signals.hpp"

namespace stillhand::close_the_loop {

/// What becomes of an effect in the canceller.
struct Treatment {
  std::string kind;
  bool cancelled = false;
  std::string how;  ///< one sentence: what the motor does about it, or why nothing
};

/// A diagnosed model as the canceller runs it.
struct ConvertedModel {
  cancellation::ControlModel model;
  double conversion_error = 0.0;      ///< Eq. CL-2, worst of its paths [-]
  std::vector<Treatment> treatments;  ///< one an effect
};

/// How a model is carried over.
struct ControlOptions {
  double low_hz = 0.5;      ///< [Hz] the motion's band, met with full weight
  double high_hz = 4.0;     ///< [Hz]
  double upper_hz = 10.0;   ///< [Hz] met with less weight to here
  double max_error = 0.05;  ///< [-] Eq. CL-2
  double lead_s = 0.0;      ///< [s] by which the motor is late: the prediction comes as much sooner
};

/// The hand that the adaptation counts on: an average person's, as the command filter's.
cancellation::HandCompliance average_hand();

/// Carries a diagnosed model to the control rate, README Eq. CL-1 to CL-4: the body's poles by
/// z' = z^(rate/1000 Hz), each numerator by least squares on its response, springs inside the body,
/// paths beside it and waves as they are.  Offset, drift and bursts are no feedthrough and stay
/// out; what the sensors did to the force (a limit, a delay of the cell) isn't felt by the hand and
/// stays out too.
/// @param signals  what the model was fitted to: ranges of its tables
/// @throws stillhand::ConfigError when an error exceeds options.max_error.
ConvertedModel to_control_model(const diagnosis::Model& model, const diagnosis::Signals& signals,
                                const ControlOptions& options = {});

/// The same without a diagnosis, for what the drive does: friction against the sign of omega and
/// ripple of theta, as found in the force that the hand needs to move the stick.
/// @param share  [-] of the friction that the motor takes over: more than all of it would hunt
void add_drive_effect(const diagnosis::Effect& effect, double share, ConvertedModel& to);

}  // namespace stillhand::close_the_loop
