// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "services/bus/serialized_sample.hpp"

namespace stillhand::runtime {

/// A participant that only writes, and only bytes.  Owns the participant.  One thread.
class SerializedWriters {
 public:
  /// @throws BusError when DDS creates no publisher
  explicit SerializedWriters(edds::DomainParticipant* participant);
  ~SerializedWriters();
  SerializedWriters(const SerializedWriters&) = delete;
  SerializedWriters& operator=(const SerializedWriters&) = delete;

  /// @param keyed  of a type that idl/ does not define  @returns its number  @throws BusError
  std::size_t add(const std::string& topic, const std::string& type, bool keyed,
                  const edds::DataWriterQos& qos);
  /// CDR with its encapsulation header.  @returns false when DDS did not take it.
  bool write(std::size_t writer, std::span<const std::byte> bytes);
  /// Readers matched with this writer now.
  [[nodiscard]] std::uint32_t matched(std::size_t writer) const;
  /// Waits until reliable readers have everything, or for `limit_ns`.
  bool wait_for_acknowledgments(std::int64_t limit_ns);
  [[nodiscard]] const edds::Publisher& publisher() const { return *publisher_; }

 private:
  // Fast DDS 2.9.1 crashes on a missed offered deadline when the writer has no listener of its own.
  struct Writer final : edds::DataWriterListener {
    void on_publication_matched(edds::DataWriter*,
                                const edds::PublicationMatchedStatus& status) override;
    void on_offered_deadline_missed(edds::DataWriter*,
                                    const edds::OfferedDeadlineMissedStatus&) override {}

    edds::DataWriter* writer = nullptr;
    std::atomic<std::uint32_t> matched{0};
  };

  std::vector<std::unique_ptr<Writer>> writers_;
  std::map<std::string, edds::Topic*> topics_;
  edds::DomainParticipant* participant_;
  edds::Publisher* publisher_;
  SerializedSample sample_;
};

}  // namespace stillhand::runtime
