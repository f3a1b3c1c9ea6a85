// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/deploy_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/verb.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::deploy::deploy_command_test {
namespace {

using testing::HasSubstr;

int status_of(const std::vector<std::string>& words) {
  return support::run_verb(add_deploy_command, words);
}
std::string refusal_of(const std::vector<std::string>& words) {
  return support::refusal_of(add_deploy_command, words);
}

std::string lab_of(const std::string& address) {
  return "lab: bench\nhosts: [{name: pc, address: " + address + ", services: [" + kAllServices +
         "]}]";
}

TEST(DeployCommandTest, OfAWrongInventoryNothingIsGenerated) {
  const SampleFolder folder;
  const std::string out = folder.path() / "made";
  EXPECT_THAT(refusal_of({"deploy", "generate", folder.file("lab: x\nhost: []\n"), "--out", out}),
              HasSubstr("inventory.yaml:2:1"));
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(status_of({"deploy", "generate", folder.file(lab_of("10.0.0.1")), "--out", out}), 0);
  EXPECT_TRUE(std::filesystem::exists(out + "/pc/profiles.xml"));
}

// 203.0.113.0/24 is for documentation: no interface has one of its addresses.
TEST(DeployCommandTest, AMachineWithoutTheHostsAddressIsWrongInTextAndJson) {
  const SampleFolder folder;
  const std::string json = folder.path() / "check.json";
  EXPECT_EQ(status_of({"deploy", "check", folder.file(lab_of("203.0.113.77")), "--host", "pc",
                       "--json", json}),
            1);
  std::ifstream stream(json);
  const auto sut = nlohmann::json::parse(stream);
  EXPECT_EQ(sut["lab"], "bench");
  EXPECT_EQ(sut["host"], "pc");
  EXPECT_EQ(sut["good"], false);
  EXPECT_EQ(sut["checks"][0]["check"], "address");
  EXPECT_EQ(sut["checks"][0]["state"], "wrong");
  EXPECT_THAT(sut["checks"][0]["mend"], HasSubstr("203.0.113.77"));
}

TEST(DeployCommandTest, AHostThatTheInventoryLacksIsRefused) {
  const SampleFolder folder;
  EXPECT_THAT(refusal_of({"deploy", "check", folder.file(lab_of("10.0.0.1")), "--host", "desk"}),
              HasSubstr("--host: got desk, want one of pc"));
}

TEST(DeployCommandTest, AMachineThatIsNoHostIsRefused) {
  const SampleFolder folder;
  EXPECT_THAT(refusal_of({"deploy", "check", folder.file(lab_of("203.0.113.77"))}),
              HasSubstr("the name of this machine: pc"));
}

}  // namespace
}  // namespace stillhand::deploy::deploy_command_test
