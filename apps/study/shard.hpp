// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/study/output.hpp"

namespace stillhand::study {

/// One of `of` parts of a study: subjects that follow each other; the parts differ by at most one
/// subject in size.
struct Shard {
  std::int64_t number = 1;  ///< counted from 1
  std::int64_t of = 1;

  /// Index of its first subject in a study of `subjects`; that of the next shard ends it.
  [[nodiscard]] std::int64_t first(std::int64_t subjects) const noexcept {
    return (number - 1) * subjects / of;
  }
  [[nodiscard]] std::int64_t end(std::int64_t subjects) const noexcept {
    return number * subjects / of;
  }
};

/// "K/N" of --shard.  @throws ConfigError for other words, and for more shards than subjects.
Shard parse_shard(const std::string& word, std::int64_t subjects);

/// Name of the one file of a shard's folder; METHOD, "shard.cbor".
inline constexpr const char* kShardFile = "shard.cbor";
/// Its last item, a digest: a text of 64 characters as CBOR.
inline constexpr std::size_t kShardDigestBytes = 66;

/// Content of that file: header, the results of its subjects, digest.
/// @param record  `results` holds the subjects of the shard alone; the rig's motor and the arm rest
///                are those of a default StudyOptions
std::string shard_file(const StudyRecord& record, const Shard& shard);

/// Writes that file; files of an earlier study are removed.
/// @throws std::runtime_error with the file that could not be written and the reason
void write_shard(const StudyRecord& record, const Shard& shard, report::StagedFolder& folder);

/// Puts the folders of all shards of one study together: options, sealed effect, time and the
/// results in the order of the subjects.  Wrong models and analysis are left to the caller.
/// @throws ConfigError naming the folder, for a missing or a second shard, a shard of other
///         settings or another version, and a file that is damaged or not there.
StudyRecord merged(const std::vector<std::filesystem::path>& folders);

}  // namespace stillhand::study
