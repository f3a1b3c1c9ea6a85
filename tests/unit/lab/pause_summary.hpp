// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

namespace stillhand::lab {

/// What the lab reads of `summary.json` of `stillhand close-the-loop --pegged`.
inline nlohmann::ordered_json pause_summary() {
  return {{"verdict", {{"kind", "dead_zone"}}},
          {"treatments", {{{"kind", "dead_zone"}, {"cancelled", true}, {"how", "in the body"}}}},
          {"not_carried", nullptr},
          {"decided_on", "motor"},
          {"kept", true},
          {"unseen", {{{"seconds", 36.0}}}},
          {"decision",
           {{"linear", {{"rms", 1.462}}},
            {"augmented", {{"rms", 0.809}}},
            {"less", 0.447},
            {"less_interval95", {0.31, 0.52}}}}};
}

}  // namespace stillhand::lab
