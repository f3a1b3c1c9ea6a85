// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/part.hpp"

#include <algorithm>

namespace stillhand::cancellation {
namespace {

bool any(const std::vector<Part>& parts, auto fact) {
  return std::ranges::any_of(parts, [&](const Part& part) {
    const PartRow* const row = row_of(part.kind);
    return row != nullptr && row->*fact;
  });
}

}  // namespace

const PartRow* row_of(PartKind kind) {
  const auto* const row = std::ranges::find(kPartRows, kind, &PartRow::kind);
  return row == kPartRows.end() ? nullptr : row;
}

bool needs_force(const std::vector<Part>& parts) { return any(parts, &PartRow::needs_force); }
bool needs_position(const std::vector<Part>& parts) { return any(parts, &PartRow::needs_position); }
bool drives_motor(const std::vector<Part>& parts) { return any(parts, &PartRow::drives_motor); }
bool opposes_feedthrough(const std::vector<Part>& parts) {
  return drives_motor(parts) && !any(parts, &PartRow::answers_stick);
}

}  // namespace stillhand::cancellation
