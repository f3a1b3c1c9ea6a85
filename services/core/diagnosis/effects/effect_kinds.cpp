// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>

#include "services/core/diagnosis/effects/kinds.hpp"

namespace stillhand::diagnosis {

const std::vector<const EffectKind*>& effect_kinds() {
  static const std::vector<const EffectKind*> kKinds = [] {
    std::vector<const EffectKind*> all;
    std::ranges::transform(kEffectKinds, std::back_inserter(all),
                           [](const auto& kind) { return &kind(); });
    return all;
  }();
  return kKinds;
}

}  // namespace stillhand::diagnosis
