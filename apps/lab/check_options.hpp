// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/lab/lab_options.hpp"
#include "apps/lab/rehearsal.hpp"

namespace stillhand::lab {

/// Checks the options before the lab touches anything, and rehearses every trial's motion.
/// @throws ConfigError for what the user can mend
AskedMotions check_options(const LabOptions& options);

}  // namespace stillhand::lab
