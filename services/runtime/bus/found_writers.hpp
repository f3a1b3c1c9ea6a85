// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "services/runtime/bus/found_writer.hpp"

namespace stillhand::runtime {

/// Every discovered writer, numbered in the order of discovery; writers that left stay.
/// Any thread; every call locks.
class FoundWriters {
 public:
  using Handle = eprosima::fastrtps::rtps::InstanceHandle_t;

  /// Discovery does not carry HISTORY, so the depth is that of the catalogue's profiles.  Before
  /// the first reader.  @throws ConfigError when `profiles` lacks one
  void learn_depths(const eprosima::fastdds::dds::Publisher& publisher,
                    const std::filesystem::path& profiles);

  void note_participant(const eprosima::fastrtps::rtps::GuidPrefix_t& prefix,
                        const std::string& name);
  void note_participant(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  /// @param wanted  whether its topic is wanted  @returns its number when it is new
  std::optional<std::size_t> note_writer(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& info,
                                         bool wanted = true);

  [[nodiscard]] std::optional<std::size_t> find(const Handle& writer) const;
  /// As known now.
  [[nodiscard]] FoundWriter at(std::size_t number) const;
  [[nodiscard]] std::vector<FoundWriter> all() const;

 private:
  [[nodiscard]] FoundWriter complete(FoundWriter writer) const;

  mutable std::mutex mutex_;
  std::deque<FoundWriter> writers_;
  std::map<Handle, std::size_t> by_handle_;
  std::map<eprosima::fastrtps::rtps::GuidPrefix_t, std::string> participants_;
  std::map<std::string, std::int32_t> depth_of_;  // by profile
};

/// The writers of one reader's samples, as known at the first sample of each.  Locks only
/// when the writer differs from that of the sample before.  One thread.
class SampleWriters {
 public:
  struct Entry {
    std::size_t number;
    FoundWriter writer;
  };

  explicit SampleWriters(const FoundWriters& all) : all_(all) {}

  /// Valid as long as this object; nullptr for a writer that discovery did not announce.
  const Entry* of(const FoundWriters::Handle& writer);

 private:
  const FoundWriters& all_;
  std::map<FoundWriters::Handle, Entry> known_;
  FoundWriters::Handle newest_;
  const Entry* entry_ = nullptr;
};

}  // namespace stillhand::runtime
