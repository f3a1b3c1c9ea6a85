// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/common/InstanceHandle.h>

#include <atomic>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace stillhand::runtime {

/// Who is on the bus: names of participants by GUID, and which services show a life sign.  A
/// participant of Stillhand is named "stillhand/<rig>/<service>".  Called from DDS's threads and
/// the owner's; every call locks, none is made in the control path except alive().
class Peers final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  Peers(std::string self, std::uint32_t rig);

  static std::string participant_name(std::uint32_t rig, const std::string& service);

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;

  /// Service of this rig that owns an endpoint, or "" for a stranger or another rig's.
  [[nodiscard]] std::string service_of(
      const eprosima::fastrtps::rtps::InstanceHandle_t& endpoint) const;
  /// A status writer came alive or stopped being so.  @return true when that changed anything.
  bool set_alive(const eprosima::fastrtps::rtps::InstanceHandle_t& writer, bool alive);

  /// Each service of the catalogue but this one has a live status writer.  Wait-free.
  [[nodiscard]] bool alive() const noexcept { return all_alive_.load(std::memory_order_acquire); }
  [[nodiscard]] std::vector<std::string> lost() const;
  [[nodiscard]] std::vector<std::string> duplicates() const;

 private:
  void refresh();

  std::string self_;
  std::string prefix_;
  mutable std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GuidPrefix_t, std::string> services_;  // by participant
  std::map<eprosima::fastrtps::rtps::InstanceHandle_t, std::string> alive_writers_;
  std::set<std::string> ever_alive_;
  std::atomic<bool> all_alive_{false};
};

}  // namespace stillhand::runtime
