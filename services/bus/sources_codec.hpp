// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "idl/session.h"
#include "services/bus/source.hpp"

namespace stillhand::runtime {

stillhand_msgs::SessionSources to_idl(const std::vector<Source>& sources);
/// Nothing where a participant is not 24 hexadecimal digits.
std::optional<std::vector<Source>> from_idl(const stillhand_msgs::SessionSources& message);

}  // namespace stillhand::runtime
