// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/bus/announced.hpp"
#include "services/bus/found_writer.hpp"

namespace stillhand::runtime {

/// Discovered writers, numbered in the order of discovery.  Those that left stay, up to kMost
/// altogether: then the first that left without a sample makes room, and if there is none, a new
/// writer is not found.  So strangers that come and go fill no memory, and neither do their types:
/// beyond kMostIdlBytes a further definition is not kept.  Any thread; every call locks.
class FoundWriters {
 public:
  static constexpr std::size_t kMost = 65535;  ///< what one recording can hold (MCAP)
  static constexpr std::size_t kMostIdlBytes = std::size_t{16} << 20;  ///< [B]
  using Handle = ertps::InstanceHandle_t;

  /// Discovery does not carry HISTORY, so the depth is that of the catalogue's profiles.  Before
  /// the first reader.  @throws ConfigError when `profiles` lacks one
  void learn_depths(const edds::Publisher& publisher, const std::filesystem::path& profiles);

  void note_participant(const ertps::GuidPrefix_t& prefix, const std::string& name);
  void note_participant(const AnnouncedParticipant& announced);
  /// @param wanted  whether its topic is wanted  @returns its number when it is new
  std::optional<std::size_t> note_writer(const AnnouncedWriter& announced, bool wanted = true);

  /// Number of the writer of a sample.
  std::optional<std::size_t> find(const Handle& writer);
  /// As known now.
  [[nodiscard]] FoundWriter at(std::size_t number) const;
  [[nodiscard]] std::vector<FoundWriter> all() const;

 private:
  struct Entry {
    FoundWriter writer;
    Handle handle;
    bool heard = false;  ///< a sample came from it
  };
  [[nodiscard]] FoundWriter complete(FoundWriter writer) const;
  std::string_view keep(const std::string& idl);
  bool make_room();

  mutable std::mutex mutex_;
  std::map<std::size_t, Entry> writers_;  // by number
  std::size_t next_ = 0;
  std::map<Handle, std::size_t> by_handle_;
  std::map<ertps::GuidPrefix_t, std::string> participants_;
  std::map<std::string, std::int32_t> depth_of_;  // by profile
  std::set<std::string> idl_;                     // each text once
  std::size_t idl_bytes_ = 0;
};

/// The writers of one reader's samples, as known at the first sample of each.  Locks only
/// when the writer differs from that of the sample before.  One thread.
class SampleWriters {
 public:
  struct Entry {
    std::size_t number;
    FoundWriter writer;
  };

  explicit SampleWriters(FoundWriters& all) : all_(all) {}

  /// Valid as long as this object; nullptr for a writer that discovery did not announce.
  const Entry* of(const FoundWriters::Handle& writer);

 private:
  FoundWriters& all_;
  std::map<FoundWriters::Handle, Entry> known_;
  FoundWriters::Handle newest_;
  const Entry* entry_ = nullptr;
};

}  // namespace stillhand::runtime
