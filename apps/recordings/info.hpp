// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/recordings/open_recording.hpp"

namespace stillhand::recordings {

/// One topic of a recording, of one type: all channels of it together.
struct TopicInfo {
  std::string topic;
  std::string type;                          ///< empty: its schema is not there
  std::string encoding;                      ///< of the messages: "cdr"
  std::string schema_encoding;               ///< "omgidl"
  std::vector<recording::TextMap> channels;  ///< of each: its writer, QoS, what else was kept
  std::uint64_t messages = 0;                ///< [-] delivered
  std::uint64_t first_ns = 0;                ///< [ns] log time
  std::uint64_t last_ns = 0;
  double rate_hz = 0.0;  ///< [Hz] mean; 0 with fewer than two messages
  /// [-] gaps in each channel's tick numbers, of the 1 kHz topics of the catalogue; others have no
  /// such count
  std::optional<std::int64_t> lost_ticks;
};

/// The content of a recording, found by reading all of it.
struct RecordingInfo {
  std::string path;
  std::uint64_t bytes = 0;
  std::string program;  ///< that wrote it
  std::string profile;
  bool whole = false;          ///< closed, and nothing damaged
  bool being_written = false;  ///< a recorder has it open
  std::uint64_t messages = 0;
  std::uint64_t start_ns = 0;  ///< [ns] earliest log time
  std::uint64_t end_ns = 0;
  std::uint32_t chunks = 0;
  std::uint32_t attachments = 0;
  std::vector<std::string> packings;  ///< "zstd", "lz4", "none"
  std::vector<TopicInfo> topics;
  std::vector<recording::Metadata> metadata;
  std::vector<recording::Damage> damage;
  std::vector<recording::ClockStep> clock_steps;  ///< which no time above has
  std::uint64_t lost_bytes = 0;
};

/// Reads all of it, and checks every checksum.  @throws std::runtime_error when the disk fails.
RecordingInfo info_of(OpenRecording& recording);

std::string info_text(const RecordingInfo& info);
std::string info_json(const RecordingInfo& info);
/// Findings, one a line: "byte 123: 45 bytes lost: chunk lost: its checksum differs".
std::string damage_text(const std::vector<recording::Damage>& damage);

}  // namespace stillhand::recordings
