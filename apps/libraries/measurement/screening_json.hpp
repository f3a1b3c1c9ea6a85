// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "services/core/diagnosis/record/measurement.hpp"

namespace stillhand::measurement {

/// `screening` of a verb's JSON.
inline nlohmann::ordered_json screening_json(const std::vector<diagnosis::SampleFault>& faults) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const diagnosis::SampleFault& fault : faults) {
    out.push_back({{"channel", fault.channel},
                   {"what", fault.what},
                   {"times_s", fault.times_s},
                   {"share", fault.share},
                   {"unsound", fault.unsound},
                   {"text", fault.says}});
  }
  return out;
}

}  // namespace stillhand::measurement
