// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/close_the_loop/verdict/control_model.hpp"

namespace stillhand::close_the_loop {

/// Factor on the body's force by an effect that changes it over time, as it is over the last tenth
/// of the record: where the hand is when the recording ends.
double gain_at_the_end(const diagnosis::Effect& effect, const diagnosis::Signals& signals);

/// One try at carrying a model over to the control rate, METHOD Eq. CL-1 to CL-4: with one
/// denominator, every effect by its body_role().  Nothing is compared yet.
/// @throws stillhand::ConfigError for an input that the canceller does not receive.
ConvertedModel converted(const diagnosis::Model& model, const diagnosis::Signals& signals,
                         const std::vector<double>& denominator, const ControlOptions& options);

}  // namespace stillhand::close_the_loop
