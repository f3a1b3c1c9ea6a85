// SPDX-License-Identifier: Apache-2.0
// The instance that a message belongs to, by its key: as the generated code computes it, and the
// same from several threads.
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "fast_dds/types.hpp"
#include "idl/clockPubSubTypes.h"
#include "idl/control_loopPubSubTypes.h"
#include "idl/sessionPubSubTypes.h"
#include "services/bus/bus.hpp"
#include "services/bus/type_tag.hpp"

namespace stillhand::runtime {
namespace {

template <typename Message>
ertps::InstanceHandle_t key_of(Message message, bool force_md5 = false) {
  ertps::InstanceHandle_t handle;
  auto support = type_tag<Message>().support;
  EXPECT_TRUE(runtime::key_of(*support, &message, handle, force_md5));
  return handle;
}

template <typename Generated>
ertps::InstanceHandle_t generated_key_of(typename Generated::type message, bool force_md5 = false) {
  ertps::InstanceHandle_t handle;
  Generated generated;
  EXPECT_TRUE(runtime::key_of(generated, &message, handle, force_md5));
  return handle;
}

stillhand_msgs::ServiceStatus status_of(const std::string& service) {
  stillhand_msgs::ServiceStatus status;
  status.rig(3);
  status.service(service);
  return status;
}

TEST(MessageKeyTest, IsTheGeneratedOneForShortKeysAndLongOnes) {
  using namespace stillhand_msgs;  // NOLINT(google-build-using-namespace): types of this test
  MotorCommand command;
  command.rig(0x01020304);
  EXPECT_EQ(key_of(command), generated_key_of<MotorCommandPubSubType>(command));
  EXPECT_EQ(key_of(command, true), generated_key_of<MotorCommandPubSubType>(command, true));
  for (const std::string service :
       {"", "rig", "identification", "a name of thirty-two characters!"}) {
    const ServiceStatus status = status_of(service.substr(0, 32));
    EXPECT_EQ(key_of(status), generated_key_of<ServiceStatusPubSubType>(status)) << service;
  }
  ClockOffset offset;
  offset.rig(2);
  offset.service("display");
  EXPECT_EQ(key_of(offset), generated_key_of<ClockOffsetPubSubType>(offset));
}

// A service writes its own status in one thread and reads the others' in another.
TEST(MessageKeyTest, IsTheSameWhileOtherThreadsAskForOthers) {
  constexpr int kTimes = 100'000;
  const std::vector<std::string> services{"rig", "sensing", "human_operator"};
  std::vector<int> wrong(services.size(), 0);
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < services.size(); ++i) {
    threads.emplace_back([&, i] {
      const auto status = status_of(services[i]);
      const ertps::InstanceHandle_t right =
          generated_key_of<stillhand_msgs::ServiceStatusPubSubType>(status);
      for (int n = 0; n < kTimes; ++n) wrong[i] += key_of(status) == right ? 0 : 1;
    });
  }
  threads.clear();
  EXPECT_EQ(wrong, std::vector<int>(services.size(), 0));
}

}  // namespace
}  // namespace stillhand::runtime
