// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/core/diagnosis/detection/detection.hpp"

namespace stillhand::diagnose {

/// Every question with its answer, whiteness, coherence with the channels, and where the excitation
/// is periodic its detection lines (null otherwise).
nlohmann::ordered_json detection_json(const diagnosis::DetectionResult& result);

}  // namespace stillhand::diagnose
