// SPDX-License-Identifier: Apache-2.0
// Fast DDS 2: its names as Fast DDS 3 has them.
#pragma once

#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

namespace stillhand::runtime {

namespace edds {
using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::c_TimeInfinite;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::Time_t;
}  // namespace edds
namespace ertps {
using namespace eprosima::fastrtps::rtps;
using namespace eprosima::fastdds::rtps;
using DiscoveryProtocol = DiscoveryProtocol_t;
}  // namespace ertps

/// What Fast DDS returned is a success.
inline bool ok(const eprosima::fastrtps::types::ReturnCode_t& code) {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}
inline bool ok(bool written) { return written; }

inline edds::Duration_t& heartbeat_period(edds::DataWriterQos& qos) {
  return qos.reliable_writer_qos().times.heartbeatPeriod;
}

/// It announces no DATA_REPRESENTATION, so that its peers take it for plain CDR alone.
inline constexpr bool kHasXcdr2 = false;

inline auto& representation(edds::DataReaderQos& qos) {
  return qos.type_consistency().representation;
}

}  // namespace stillhand::runtime
