// SPDX-License-Identifier: Apache-2.0
// Fast DDS 3.
#pragma once

#include <regex>
#include <string>
#include <utility>

namespace stillhand::runtime {

/// Profiles as this version reads them: it has other names for an element of a writer's times, and
/// for a discovery server.
inline std::string readable_profiles(std::string profiles) {
  const std::pair<const char*, const char*> names[] = {
      {"(</?)heartbeatPeriod>", "$1heartbeat_period>"},
      {"<RemoteServer[^>]*>\\s*<metatrafficUnicastLocatorList>", ""},
      {"</metatrafficUnicastLocatorList>\\s*</RemoteServer>", ""}};
  for (const auto& [pattern, replacement] : names) {
    profiles = std::regex_replace(profiles, std::regex(pattern), replacement);
  }
  return profiles;
}

}  // namespace stillhand::runtime
