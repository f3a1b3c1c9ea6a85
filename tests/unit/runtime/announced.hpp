// SPDX-License-Identifier: Apache-2.0
// Participants and writers as DDS announces them, made by hand: no bus is needed.
#pragma once

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <string>
#include <vector>

#include "services/runtime/bus/replay_mark.hpp"

namespace stillhand::runtime::announced {

namespace rtps = eprosima::fastrtps::rtps;

inline rtps::GuidPrefix_t prefix_of(std::uint8_t number) {
  rtps::GuidPrefix_t prefix;
  prefix.value[0] = number;
  prefix.value[11] = 0xa0;
  return prefix;
}

/// Writer number `writer` of a participant.
inline rtps::GUID_t guid_of(std::uint8_t participant, std::uint8_t writer = 1) {
  return {prefix_of(participant), std::uint32_t{writer} << 8 | 0x02};
}

inline rtps::InstanceHandle_t handle_of(std::uint8_t participant, std::uint8_t writer = 1) {
  return rtps::InstanceHandle_t(guid_of(participant, writer));
}

/// A participant's announcement; valid as long as this lives.
class Participant {
 public:
  Participant(std::uint8_t number, const std::string& name, bool marked = false)
      : data_(rtps::RTPSParticipantAllocationAttributes{}) {
    data_.m_guid = {prefix_of(number), rtps::c_EntityId_RTPSParticipant};
    data_.m_participantName = name;
    if (marked) data_.m_userData.data_vec(replay_mark());
  }
  [[nodiscard]] rtps::ParticipantDiscoveryInfo info(
      rtps::ParticipantDiscoveryInfo::DISCOVERY_STATUS status =
          rtps::ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT) const {
    rtps::ParticipantDiscoveryInfo info(data_);
    info.status = status;
    return info;
  }

 private:
  rtps::ParticipantProxyData data_;
};

/// A writer's announcement; valid as long as this lives.
class Writer {
 public:
  Writer(std::uint8_t participant, std::uint8_t number, const std::string& topic,
         const std::string& type, const std::vector<std::uint8_t>& user_data = {})
      : data_(4, 1) {
    data_.guid(guid_of(participant, number));
    data_.topicName(topic.c_str());
    data_.typeName(type.c_str());
    data_.m_qos.m_userData.data_vec(user_data);
  }
  [[nodiscard]] rtps::WriterDiscoveryInfo info(
      rtps::WriterDiscoveryInfo::DISCOVERY_STATUS status =
          rtps::WriterDiscoveryInfo::DISCOVERED_WRITER) const {
    rtps::WriterDiscoveryInfo info(data_);
    info.status = status;
    return info;
  }
  rtps::WriterProxyData& data() { return data_; }

 private:
  rtps::WriterProxyData data_;
};

}  // namespace stillhand::runtime::announced
