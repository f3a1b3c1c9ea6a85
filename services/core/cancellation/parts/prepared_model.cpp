// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/prepared_model.hpp"

namespace stillhand::cancellation {

Preparation prepare(const ControlModel& model, const ModelBounds& bounds) noexcept {
  const ModelCheck check = check_model(model, bounds);
  if (check.refusal != Refusal::kNone) return {check.refusal, {}};
  const AdaptiveGain own = model.adapts ? AdaptiveGain(*model.adapts) : AdaptiveGain();
  return {Refusal::kNone, {ControlModelFilter(model, check.settle_ticks), HeldForce(), own, own}};
}

}  // namespace stillhand::cancellation
