// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace stillhand::topics {

/// The text of the IDL files: the schemas of a recording.
extern const std::string_view kControlLoopIdl;
extern const std::string_view kSessionIdl;
extern const std::string_view kModelIdl;
extern const std::string_view kClockIdl;
extern const std::string_view kRecordingIdl;

/// Text of the file that defines a type, by its scoped name; empty if no file defines it.
inline std::string_view idl_of(std::string_view type) {
  const std::string name(type.substr(type.rfind(':') + 1));
  for (const std::string_view text :
       {kControlLoopIdl, kSessionIdl, kModelIdl, kClockIdl, kRecordingIdl}) {
    if (text.find("struct " + name + " {") != std::string_view::npos) return text;
  }
  return {};
}

}  // namespace stillhand::topics
