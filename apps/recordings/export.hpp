// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/recordings/open_recording.hpp"

namespace stillhand::recordings {

struct ExportOptions {
  std::filesystem::path csv;   ///< folder; empty: not wanted
  std::filesystem::path mat;   ///< file
  std::filesystem::path hdf5;  ///< file
  /// Names or patterns (* any text, ? one character); empty: every topic.
  std::vector<std::string> topics;
  Stopped stopped = {};                 ///< true: give up
  std::filesystem::path lateness = {};  ///< file of the caller; none of the others is in its place
};

/// The result of one topic.
struct ExportedTopic {
  std::string topic;
  std::string name;  ///< of its file, struct or group
  std::uint64_t rows = 0;
  std::size_t columns = 0;
  std::uint64_t unread = 0;  ///< [-] messages that do not match their type
};

struct Exported {
  std::vector<ExportedTopic> topics;
  std::vector<std::string> left_out;  ///< "topic: why"
};

/// Messages of a recording as tables, one a topic, decoded by the schema that the recording itself
/// carries (omgidl; a topic of the catalogue whose schema is lost by this program's own).  The
/// results appear when all are complete, and nothing is left of them when that never happens.  Says
/// on standard error what the recording has lost.
/// @throws ConfigError when the recording can't be read, holds nothing that can be exported, or a
///         result can't be made; std::runtime_error when a disk fails; Interrupted.
Exported export_recording(const std::string& path, const ExportOptions& options);

}  // namespace stillhand::recordings
