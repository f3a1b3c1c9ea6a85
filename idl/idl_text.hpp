// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillhand::topics {

/// The text of each IDL file: the schemas of a recording.
extern const std::span<const std::string_view> kIdlTexts;

/// Text of the file that defines a type, by its scoped name; empty if no file defines it.
inline std::string_view idl_of(std::string_view type) {
  const std::string name(type.substr(type.rfind(':') + 1));
  for (const std::string_view text : kIdlTexts) {
    if (text.find("struct " + name + " {") != std::string_view::npos) return text;
  }
  return {};
}

}  // namespace stillhand::topics
