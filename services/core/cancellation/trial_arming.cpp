// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/trial_arming.hpp"

namespace stillhand::cancellation {

Readiness TrialArming::readiness(bool has_model, std::optional<Tick> next_model,
                                 const PreparedParts& prepared) const noexcept {
  if (!assigned()) return Readiness::kUnassigned;
  const Readiness parts = assignment_->parts ? made(prepared) : Readiness::kArmed;
  if (parts != Readiness::kArmed || has_model) return parts;
  const bool needs = assignment_->parts ? assignment_->needs_force : assignment_->cancellation;
  if (!needs) return Readiness::kArmed;
  if (!next_model) return Readiness::kNoModel;
  return *next_model <= trial_.start_tick ? Readiness::kArmed : Readiness::kModelTooLate;
}

}  // namespace stillhand::cancellation
