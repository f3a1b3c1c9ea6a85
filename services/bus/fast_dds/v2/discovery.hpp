// SPDX-License-Identifier: Apache-2.0
// Fast DDS 2.
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>

#include "services/bus/announced.hpp"

namespace stillhand::runtime {

/// Passes on what discovery announces, in the form that does not depend on Fast DDS's version.
class DiscoveryListener : public edds::DomainParticipantListener {
 public:
  virtual void on_participant(const AnnouncedParticipant& /*participant*/) {}
  virtual void on_writer(const AnnouncedWriter& /*writer*/) {}

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
    forget_type(info.info);
  }
  void on_subscriber_discovery(edds::DomainParticipant* /*own*/,
                               ertps::ReaderDiscoveryInfo&& info) final {
    forget_type(info.info);
  }

  // After this call Fast DDS 2.9.1 makes a dynamic type of a type object that the endpoint
  // announces, and ends with a segmentation fault where the object names a type that it does not
  // hold itself, as a sequence of a struct: any program on the domain could end every process.  The
  // object is Fast DDS's own record, which is not const.
  template <typename Endpoint>
  static void forget_type(const Endpoint& announced) {
    auto& endpoint = const_cast<Endpoint&>(announced);
    if (endpoint.has_type()) endpoint.type() = edds::TypeObjectV1();
    if (endpoint.has_type_id()) endpoint.type_id() = edds::TypeIdV1();
  }
};

}  // namespace stillhand::runtime
