// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/part.hpp"

#include <algorithm>
#include <array>

namespace stillhand::cancellation {
namespace {

/// What others than the part itself must know of a kind.
struct Facts {
  PartKind kind;
  bool needs_force = false;     ///< the model of a force
  bool needs_position = false;  ///< that of a position
  bool drives_motor = false;
  bool answers_stick =
      false;  ///< with a force that follows the stick's motion, not the feedthrough
};

constexpr std::array kFacts{
    Facts{.kind = PartKind::kForce, .needs_force = true, .drives_motor = true},
    Facts{.kind = PartKind::kSchedule, .drives_motor = true},
    Facts{.kind = PartKind::kImpedance, .drives_motor = true, .answers_stick = true},
    Facts{.kind = PartKind::kLmsForce, .drives_motor = true},
    Facts{.kind = PartKind::kSignal, .needs_position = true},
    Facts{.kind = PartKind::kPredictedSignal, .needs_force = true},
    Facts{.kind = PartKind::kLmsSignal},
    Facts{.kind = PartKind::kLowPass},
    Facts{.kind = PartKind::kNotch},
};
static_assert(kFacts.size() == kPartKinds, "a row for each kind");

bool any(const std::vector<Part>& parts, bool Facts::* fact) {
  return std::ranges::any_of(parts, [&](const Part& part) {
    const auto* const row = std::ranges::find(kFacts, part.kind, &Facts::kind);
    return row != kFacts.end() && row->*fact;
  });
}

}  // namespace

bool needs_force(const std::vector<Part>& parts) { return any(parts, &Facts::needs_force); }
bool needs_position(const std::vector<Part>& parts) { return any(parts, &Facts::needs_position); }
bool drives_motor(const std::vector<Part>& parts) { return any(parts, &Facts::drives_motor); }
bool opposes_feedthrough(const std::vector<Part>& parts) {
  return drives_motor(parts) && !any(parts, &Facts::answers_stick);
}

}  // namespace stillhand::cancellation
