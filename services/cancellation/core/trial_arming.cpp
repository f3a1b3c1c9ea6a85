// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/core/trial_arming.hpp"

namespace stillhand::cancellation {

Readiness TrialArming::readiness(bool has_model, std::optional<Tick> next_model,
                                 const PreparedMitigation& prepared) const noexcept {
  if (!assigned()) return Readiness::kUnassigned;
  if (assignment_->mitigation) return mitigation(prepared);
  if (!assignment_->cancellation || has_model) return Readiness::kArmed;
  if (!next_model) return Readiness::kNoModel;
  return *next_model <= trial_.start_tick ? Readiness::kArmed : Readiness::kModelTooLate;
}

}  // namespace stillhand::cancellation
