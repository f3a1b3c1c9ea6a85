// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/part.hpp"

#include <algorithm>
#include <initializer_list>

namespace stillhand::cancellation {
namespace {

bool has(const std::vector<Part>& parts, std::initializer_list<PartKind> kinds) {
  return std::ranges::any_of(parts, [&](const Part& part) {
    return std::find(kinds.begin(), kinds.end(), part.kind) != kinds.end();
  });
}

}  // namespace

bool needs_force(const std::vector<Part>& parts) {
  return has(parts, {PartKind::kForce, PartKind::kPredictedSignal});
}

bool needs_position(const std::vector<Part>& parts) { return has(parts, {PartKind::kSignal}); }

bool drives_motor(const std::vector<Part>& parts) {
  return has(parts,
             {PartKind::kForce, PartKind::kSchedule, PartKind::kImpedance, PartKind::kLmsForce});
}

}  // namespace stillhand::cancellation
