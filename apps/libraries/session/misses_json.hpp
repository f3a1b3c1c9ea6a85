// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/libraries/session/misses.hpp"

namespace stillhand::session {

/// One entry of `misses --json`, and of `disturbed` in a session's summary.json.
inline nlohmann::ordered_json json_of(const Miss& miss) {
  using Json = nlohmann::ordered_json;
  return Json{{"process", miss.process},
              {"topic", miss.topic},
              {"from_s", miss.from_s},
              {"gap_ms", 1e3 * miss.late_s},
              {"force_zero_s", miss.zero_s},
              {"trial", miss.trial < 0 ? Json() : Json(miss.trial)},
              {"trial_s", miss.trial < 0 ? Json() : Json(miss.trial_s)},
              {"whole_after_s", std::isfinite(miss.back_s) ? Json(miss.back_s) : Json()},
              {"waited", miss.waited},
              {"why", miss.why.empty() ? Json() : Json(miss.why)}};
}

}  // namespace stillhand::session
