// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/lab/lab_options.hpp"

namespace stillhand::lab {

/// Writes DIR/undeclared_effect.json, once the verdict is written.  The rig's executable draws the
/// same effect again from what was sealed.
/// @param sealed   LiveSession::sealed
/// @param verdict  a file in DIR
void open_undeclared_effect(const LabOptions& options, const std::string& sealed,
                            const std::string& verdict);

}  // namespace stillhand::lab
