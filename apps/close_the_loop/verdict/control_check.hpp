// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/close_the_loop/verdict/control_model.hpp"

namespace stillhand::close_the_loop {

/// The force of a control model at 1 kHz over the signals' motion, at the signals' instants.  Each
/// stretch starts from rest, its first sample at a tick at which elements with memory take a value;
/// tones keep the signals' time.  Channels that the signals lack are 0.  @return [models][samples]
std::vector<std::vector<double>> forces_of(const std::vector<cancellation::ControlModel>& models,
                                           const diagnosis::Signals& signals);

/// Another motion with the signals' spectra: other phases, and 1.25 times as large about its means.
diagnosis::Signals second_motion(const diagnosis::Signals& signals);

/// METHOD Eq. CL-7 of every effect of a model that the canceller carries, over the signals' motion
/// and over second_motion().  Pure.
/// @param model        each effect is carried; effects of time alone as the session continues them
/// @param denominator  of the conversion
std::vector<EffectDifference> effect_differences(const diagnosis::Model& model,
                                                 const diagnosis::Signals& signals,
                                                 const std::vector<double>& denominator,
                                                 const ControlOptions& options);

}  // namespace stillhand::close_the_loop
