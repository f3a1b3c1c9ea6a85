// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/cancellation/parts/adaptive_gain.hpp"
#include "services/core/cancellation/sampling.hpp"

namespace stillhand::cancellation {

/// A control model in the form that the canceller steps: the filter, and what is followed of gain
/// and phase.  Of fixed size: a copy allocates nothing.
struct PreparedModel {
  ControlModelFilter filter;
  HeldForce held;         ///< between two samples of the filter
  AdaptiveGain adaptive;  ///< as it runs
  AdaptiveGain own;       ///< as the model says, at its start
};

struct Preparation {
  Refusal refusal = Refusal::kNone;
  PreparedModel model;  ///< empty where the model is refused
};

/// Checks a control model (METHOD Eq. CC-4 and CC-14) and, if it is sound, builds its filter. Pure;
/// never throws.  It allocates and takes tens of microseconds (gain scan), or milliseconds with a
/// spring inside the body (trial run): not for the control path.
Preparation prepare(const ControlModel& model, const ModelBounds& bounds) noexcept;

}  // namespace stillhand::cancellation
