// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "apps/close_the_loop/repair/person_loop.hpp"
#include "apps/close_the_loop/session/session.hpp"
#include "services/core/cancellation/parts/adaptive_gain.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::close_the_loop {

/// A trial's recording, and the same at the rate of a diagnosis.
struct RecordedTrial {
  diagnosis::Measurement record;  ///< 1 kHz
  diagnosis::Signals signals;
};

/// @throws ConfigError
diagnosis::Measurement record_of(const TrialRun& run);
RecordedTrial recorded_trial(diagnosis::Measurement record, const diagnosis::Model& model);
diagnosis::Stretch longest(const std::vector<diagnosis::Stretch>& stretches);
/// One value a tick of the trial's longest stretch, less than a sample of the diagnosis short of
/// its end.
std::vector<double> at_1_khz(const std::vector<double>& values, const RecordedTrial& trial);

/// Of time alone: a trial does not go on with it.
bool is_past(const diagnosis::Effect& effect);

/// The trial without its feedthrough.
Course still_course(const diagnosis::Measurement& record);
/// The trial with the force of the body that tracks, METHOD Eq. CL-12.
/// @param pegged  of the trial that the body was diagnosed on
/// @param track   weights w_0, w_1 of the tracking hand's body
Course course_of(const RecordedTrial& trial, const diagnosis::Model& body,
                 const diagnosis::Signals& pegged, const cancellation::AdaptiveGain::Pair& track);

}  // namespace stillhand::close_the_loop
