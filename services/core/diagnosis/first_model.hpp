// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/diagnosis/diagnose.hpp"

namespace stillhand::diagnosis {

/// @throws stillhand::ConfigError when a channel of the model is constant, or the output is an
/// input, scaled.
void check_excitation(const Signals& signals, const std::string& source);

/// The model without effects, of the class that was asked for; "auto": static where a dynamic one
/// is hardly better.  A body that rings for long (Eq. DG-66) may have slow poles.
/// @param diagnosis  with its options; gets model class, baseline and a note
/// @param signals    are those with slow poles, if the body has some
void fit_first_model(Diagnosis& diagnosis, Signals& signals, const Blocks& blocks);

}  // namespace stillhand::diagnosis
