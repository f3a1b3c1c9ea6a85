// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fastdds/dds/publisher/qos/WriterQos.hpp>
#include <span>
#include <string>
#include <vector>

#include "fast_dds/names.hpp"

namespace stillhand::runtime {

/// A participant of which discovery brings something new.
struct AnnouncedParticipant {
  ertps::GuidPrefix_t prefix;
  std::string name;
  std::vector<std::uint8_t> user_data;
  bool here = true;  ///< false: it left
};

/// The same of a writer.
struct AnnouncedWriter {
  ertps::GUID_t guid;
  std::string topic;
  std::string type;  ///< DDS type name
  edds::WriterQos qos;
  bool here = true;
  std::string idl = {};  ///< definition of the type, if discovery describes it
};

/// Whether the description of a stranger's type is read: 64 KiB at most, and 256 types that it
/// depends on.
/// @param object_bytes  [B] of its own object, then of those that it depends on
inline bool is_bounded(std::span<const std::uint32_t> object_bytes) noexcept {
  constexpr std::uint64_t kMostBytes = 65'536;
  constexpr std::size_t kMostTypes = 1 + 256;
  if (object_bytes.size() > kMostTypes) return false;
  std::uint64_t bytes = 0;
  for (const std::uint32_t each : object_bytes) bytes += each;
  return bytes <= kMostBytes;
}

}  // namespace stillhand::runtime
