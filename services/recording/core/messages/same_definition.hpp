// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "services/recording/core/messages/omgidl.hpp"

namespace stillhand::recording {

/// Why messages of `type` by one schema are not messages of it by another: names, order and types
/// of the members, all the way down, and the values of enumerations.  Empty: they are the same.
/// Units and comments do not count.  Pure.
std::string definition_difference(const IdlSchema& recorded, const IdlSchema& known,
                                  std::string_view type);

}  // namespace stillhand::recording
