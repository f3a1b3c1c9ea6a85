// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/diagnosis/carried.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::close_the_loop {

/// METHOD Eq. CL-7: what an effect's force in the canceller differs by from that in the diagnosed
/// model, of the latter [-].
struct EffectDifference {
  double source = 0.0;  ///< over the motion that the model was fitted to
  double second = 0.0;  ///< over another one, made from its spectrum
  [[nodiscard]] double worst() const { return std::max(source, second); }
};

/// What the canceller does about an effect.
struct Treatment {
  std::string kind;
  bool cancelled = false;
  std::string how;           ///< one clause: what the motor does about it, or why it does nothing
  std::string channel = {};  ///< the first that it reads; empty: none
  std::optional<EffectDifference> difference = {};  ///< none: there was nothing to compare
};

/// A diagnosed model as the canceller runs it.
struct ConvertedModel {
  cancellation::ControlModel model;
  double conversion_error = 0.0;      ///< Eq. CL-2, worst of its paths [-]
  std::vector<Treatment> treatments;  ///< one an effect
};

/// How a model is converted.
struct ControlOptions {
  double low_hz = 0.5;      ///< [Hz] the motion's band, met with full weight
  double high_hz = 4.0;     ///< [Hz]
  double upper_hz = 10.0;   ///< [Hz] met with less weight to here
  double max_error = 0.05;  ///< [-] Eq. CL-2
  /// [-] Eq. CL-7: an effect that differs by more is left alone.
  double max_difference = 0.01;
  double lead_s = 0.0;  ///< [s] delay of the motor: the prediction comes as much sooner
};

/// The hand that the adaptation assumes: that of the population's mean subject (study SU-2).
cancellation::HandCompliance average_hand();

/// Converts a diagnosed model to the control rate, METHOD Eq. CL-1 to CL-4: the body's poles by
/// z' = z^(rate/1000 Hz), each numerator by least squares on its response, springs inside the body,
/// paths next to it and waves unchanged.  What becomes of an effect is its body_role()
/// (services/core/diagnosis/model/control_role.hpp).  Then each effect runs next to the diagnosed
/// one, Eq. CL-7.  Without those that differ too much, and a spring that the canceller refuses, the
/// model is fitted and converted again: the body that was fitted next to an effect is not that of
/// a model without it.
/// @param signals  what the model was fitted to
/// @throws stillhand::ConfigError when an error exceeds options.max_error.
ConvertedModel to_control_model(const diagnosis::Model& model, const diagnosis::Signals& signals,
                                const ControlOptions& options = {});
/// What a session goes on with of a carried model, diagnosis DG-58; an effect that it does not
/// carry is left alone.
ConvertedModel to_control_model(const diagnosis::CarriedModel& carried,
                                const diagnosis::Signals& signals,
                                const ControlOptions& options = {});

/// An effect as the session continues it: a gain of time alone stays where it is at the end.
diagnosis::Effect continued(const diagnosis::Effect& effect, const diagnosis::Signals& signals);
/// A model whose effects have changed, fitted: the body that was fitted next to other effects is
/// not that of this model.  Bursts weigh here.
diagnosis::Model fitted_again(diagnosis::Model model, const diagnosis::Signals& signals);

}  // namespace stillhand::close_the_loop
