// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/identify/identify.hpp"

namespace stillhand::identify {

/// `out.json`; README "out.json".
std::string result_json(const IdentifyResult& result);

/// The table for people, as text.
std::string result_table(const IdentifyResult& result);

}  // namespace stillhand::identify
