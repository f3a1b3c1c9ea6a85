// SPDX-License-Identifier: Apache-2.0
#include "services/bus/sources_codec.hpp"

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {

stillhand_msgs::SessionSources to_idl(const std::vector<Source>& sources) {
  stillhand_msgs::SessionSources message;
  for (const Source& source : sources) {
    stillhand_msgs::NamedSource entry;
    entry.service(source.service);
    entry.participant(text_of(source.participant));
    message.sources().push_back(std::move(entry));
  }
  return message;
}

std::optional<std::vector<Source>> from_idl(const stillhand_msgs::SessionSources& message) {
  std::vector<Source> sources;
  try {
    for (const stillhand_msgs::NamedSource& entry : message.sources()) {
      sources.push_back({entry.service().c_str(),
                         participant_of(entry.participant().c_str(), "session_sources")});
    }
  } catch (const ConfigError&) {
    return std::nullopt;
  }
  return sources;
}

}  // namespace stillhand::runtime
