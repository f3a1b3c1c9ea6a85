// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace stillhand::settings {

/// "file:line:column" of a place in a YAML text, counted from 1.
std::string place_of(const YAML::Mark& mark, const std::string& source_name);

/// The one document of a YAML text; null for an empty text.
/// YAML::LoadAll() of yaml-cpp 0.7 never returns for ", a: 1": it takes a document there that
/// consumes nothing, for ever.
/// @throws stillhand::ConfigError for malformed YAML and for a second document.
YAML::Node one_document(const std::string& yaml, const std::string& source_name);

}  // namespace stillhand::settings
