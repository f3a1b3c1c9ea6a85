// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "services/core/recording/messages/omgidl.hpp"

namespace stillhand::recording {

/// The difference between the definitions of `type` in two schemas.  It compares names, order and
/// types of the members at all levels, and the values of enumerations.  Empty: the definitions are
/// the same.  Units and comments do not count, and neither do values that `known` adds at the end
/// of an enumeration.  Pure.
/// @param may_lack_last  the recorded type may lack members at the end of the known one
std::string definition_difference(const IdlSchema& recorded, const IdlSchema& known,
                                  std::string_view type, bool may_lack_last = false);

}  // namespace stillhand::recording
