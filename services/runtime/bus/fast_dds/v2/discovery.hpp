// SPDX-License-Identifier: Apache-2.0
// Fast DDS 2.
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
                                ertps::ParticipantDiscoveryInfo&& info) final {
    using Info = ertps::ParticipantDiscoveryInfo;
    on_participant({info.info.m_guid.guidPrefix, info.info.m_participantName.to_string(),
                    info.info.m_userData.data_vec(),
                    info.status == Info::DISCOVERED_PARTICIPANT ||
                        info.status == Info::CHANGED_QOS_PARTICIPANT});
  }
  void on_publisher_discovery(edds::DomainParticipant* /*own*/,
                              ertps::WriterDiscoveryInfo&& info) final {
    on_writer({info.info.guid(), info.info.topicName().to_string(),
               info.info.typeName().to_string(), info.info.m_qos,
               info.status != ertps::WriterDiscoveryInfo::REMOVED_WRITER});
  }
};

}  // namespace stillhand::runtime
