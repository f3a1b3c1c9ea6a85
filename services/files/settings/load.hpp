// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "services/files/settings/section.hpp"

namespace stillhand::settings {

/// A Config from a parsed section.  A missing key keeps its default; a group is a nested map.
/// @throws stillhand::ConfigError "<file>:<line>:<column>: <scope>.<key>: got ..., want ..." for an
///         unknown key, a wrong type, a value that is not finite or out of its range.
template <typename Config>
Config load_section(const Entry& section, const std::string& scope) {
  Config config;
  SectionReader reader(section, scope);
  Config::fields(reader, config);
  reader.refuse_unknown();
  return config;
}

/// A Config from YAML text.  @param source_name  name of the text in messages
template <typename Config>
Config load_text(const std::string& yaml, const std::string& scope,
                 const std::string& source_name = "text") {
  return load_section<Config>(parse_text(yaml, source_name), scope);
}

/// A Config from a YAML file whose top level is the Config.
/// @param scope  prefix of keys in messages, for example "motion"; not a key of the file
template <typename Config>
Config load(const std::filesystem::path& file, const std::string& scope) {
  return load_section<Config>(parse_file(file), scope);
}

}  // namespace stillhand::settings
