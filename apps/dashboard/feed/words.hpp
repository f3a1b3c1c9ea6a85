// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "apps/dashboard/core/bus_health.hpp"
#include "idl/session.h"

namespace stillhand::dashboard {

/// Names in the JSON, which the page shows.
const char* word(Level level);
const char* word(Watch watch);
const char* word(stillhand_msgs::EventKind kind);
/// Of an alarm's value.
const char* unit(Watch watch);
/// Severity of an event.
Level level_of(stillhand_msgs::EventKind kind);
/// The one process that writes a topic, or "".
std::string_view writer_of(const std::string& topic);

}  // namespace stillhand::dashboard
