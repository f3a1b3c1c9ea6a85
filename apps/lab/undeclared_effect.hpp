// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/lab/lab.hpp"

namespace stillhand::lab {

/// Writes DIR/undeclared_effect.json, once the verdict is written.  The rig's executable draws the
/// same effect again from what was sealed.
/// @param verdict  a file in DIR
void open_undeclared_effect(const LabOptions& options, const LiveSession& session,
                            const std::string& verdict);

}  // namespace stillhand::lab
