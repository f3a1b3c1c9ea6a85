// SPDX-License-Identifier: Apache-2.0
// Fast DDS 3.
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include "services/runtime/bus/announced.hpp"

namespace stillhand::runtime {

/// Passes on what discovery announces, in the form that does not depend on Fast DDS's version.
class DiscoveryListener : public edds::DomainParticipantListener {
 public:
  virtual void on_participant(const AnnouncedParticipant& participant) = 0;
  virtual void on_writer(const AnnouncedWriter& writer) = 0;

 private:
  void on_participant_discovery(edds::DomainParticipant* /*own*/,
                                ertps::ParticipantDiscoveryStatus reason,
                                const edds::ParticipantBuiltinTopicData& info,
                                bool& /*ignore*/) final {
    using Status = ertps::ParticipantDiscoveryStatus;
    on_participant(
        {info.guid.guidPrefix, info.participant_name.to_string(), info.user_data.data_vec(),
         reason == Status::DISCOVERED_PARTICIPANT || reason == Status::CHANGED_QOS_PARTICIPANT});
  }
  void on_data_writer_discovery(edds::DomainParticipant* /*own*/,
                                ertps::WriterDiscoveryStatus reason,
                                const edds::PublicationBuiltinTopicData& info,
                                bool& /*ignore*/) final {
    edds::WriterQos qos;
    qos.m_reliability = info.reliability;
    qos.m_durability = info.durability;
    qos.m_liveliness = info.liveliness;
    qos.m_ownership = info.ownership;
    qos.m_deadline = info.deadline;
    qos.m_lifespan = info.lifespan;
    qos.m_userData = info.user_data;
    qos.m_partition = info.partition;
    on_writer({info.guid, info.topic_name.to_string(), info.type_name.to_string(), qos,
               reason != ertps::WriterDiscoveryStatus::REMOVED_WRITER});
  }
};

}  // namespace stillhand::runtime
