// SPDX-License-Identifier: Apache-2.0
#include "services/bus/ros2_writers.hpp"

#include "services/bus/discovered_qos.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/serialized_writers.hpp"
#include "services/bus/surroundings.hpp"

namespace stillhand::runtime {
namespace {

// KEEP_LAST of rmw_qos_profile_default.
constexpr std::int32_t kDepth = 10;

edds::DomainParticipantQos participant_qos(const std::string& name,
                                           const std::vector<std::string>& addresses) {
  edds::DomainParticipantQos qos;
  qos.name(name);
  // By this ROS 2 knows a participant of its own kind.
  const std::string enclave = "enclave=/;";
  qos.user_data().data_vec({enclave.begin(), enclave.end()});
  auto udp = std::make_shared<ertps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = addresses;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {udp};
  check_surroundings(qos, "--ros-address");
  return qos;
}

}  // namespace

struct Ros2Writers::Impl {
  SerializedWriters writers;
};

Ros2Writers::Ros2Writers(std::uint32_t domain, const std::string& name,
                         const std::vector<std::string>& addresses)
    : impl_(new Impl{SerializedWriters(
          create_participant(domain, participant_qos(name, addresses), nullptr))}) {}

Ros2Writers::~Ros2Writers() = default;

std::size_t Ros2Writers::add(const std::string& topic, const std::string& type,
                             const std::string& hash) {
  edds::DataWriterQos qos = offered_qos({.reliable = true, .depth = kDepth});
  const std::string words = "typehash=" + hash + ";";
  qos.user_data().data_vec({words.begin(), words.end()});
  return impl_->writers.add("rt" + topic, type, false, qos);
}

bool Ros2Writers::write(std::size_t writer, std::span<const std::byte> bytes) {
  return impl_->writers.write(writer, bytes);
}

std::uint32_t Ros2Writers::matched(std::size_t writer) const {
  return impl_->writers.matched(writer);
}

}  // namespace stillhand::runtime
