// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace stillhand::topics {

/// The IDL files, word for word: the schemas a recording carries.
extern const std::string_view kControlLoopIdl;
extern const std::string_view kSessionIdl;
extern const std::string_view kModelIdl;

}  // namespace stillhand::topics
