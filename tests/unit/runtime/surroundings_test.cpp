// SPDX-License-Identifier: Apache-2.0
#include "services/bus/surroundings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "tests/support/refusal.hpp"

namespace stillhand::runtime::surroundings_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

edds::DomainParticipantQos on(const std::string& address) {
  edds::DomainParticipantQos qos;
  auto udp = std::make_shared<ertps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {address};
  qos.transport().user_transports.push_back(udp);
  return qos;
}

std::string refusal(const edds::DomainParticipantQos& qos) {
  return support::refusal([&] { check_surroundings(qos, "profiles.xml: interfaceWhiteList"); });
}

TEST(SurroundingsTest, LoopbackIsThere) { EXPECT_EQ(refusal(on("127.0.0.1")), "accepted"); }

TEST(SurroundingsTest, AnAddressThatNoInterfaceHasIsNamed) {
  // RFC 5737: of documents, no machine's.
  EXPECT_THAT(refusal(on("192.0.2.1")), AllOf(HasSubstr("profiles.xml"), HasSubstr("192.0.2.1")));
}

TEST(SurroundingsTest, AVariableThatSendsFastDdsToAServerIsNamed) {
  for (const char* name : {"ROS_DISCOVERY_SERVER", "FASTDDS_ENVIRONMENT_FILE"}) {
    ASSERT_EQ(setenv(name, "127.0.0.1:11811", 1), 0);
    EXPECT_THAT(refusal(on("127.0.0.1")), AllOf(HasSubstr(name), HasSubstr("127.0.0.1:11811")));
    auto with_server = on("127.0.0.1");
    with_server.wire_protocol().builtin.discovery_config.discoveryProtocol =
        ertps::DiscoveryProtocol::SUPER_CLIENT;
    EXPECT_EQ(refusal(with_server), "accepted");
    ASSERT_EQ(setenv(name, "", 1), 0);
    EXPECT_EQ(refusal(on("127.0.0.1")), "accepted");
    unsetenv(name);
  }
}

}  // namespace
}  // namespace stillhand::runtime::surroundings_test
