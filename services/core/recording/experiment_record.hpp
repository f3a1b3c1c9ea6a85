// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::recording {

/// Name of the metadata record of a recording that belongs to an experiment with participants.
inline constexpr const char* kExperimentRecord = "stillhand.experiment";

}  // namespace stillhand::recording
