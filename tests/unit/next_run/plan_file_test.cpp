// SPDX-License-Identifier: Apache-2.0
#include "services/files/next_run/plan_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/next_run/two_channels.hpp"

namespace stillhand::next_run {
namespace {

class PlanFileTest : public testing::Test {
 protected:
  PlanFileTest() : path_(std::filesystem::path(testing::TempDir()) / "plan_file_test.json") {
    json_["seconds"] = 30.0;
    json_["candidates"] = {json_of(made::candidate("x")), json_of(made::candidate("z"))};
  }
  PlanFile read() {
    std::ofstream(path_) << json_.dump();
    return read_plan(path_);
  }

  std::filesystem::path path_;
  nlohmann::ordered_json json_;
};

TEST_F(PlanFileTest, ComesBackAsItWasWritten) {
  const PlanFile sut = read();
  EXPECT_EQ(sut.seconds, 30.0);
  EXPECT_EQ(sut.ride, path_.parent_path() / "ride.csv");
  ASSERT_EQ(sut.candidates.size(), 2U);
  EXPECT_EQ(sut.candidates[1].cause().channels, std::vector<std::string>{"z"});
  EXPECT_EQ(diagnosis::packed(sut.candidates[1].model),
            diagnosis::packed(made::candidate("z").model));
}

TEST_F(PlanFileTest, AnEffectThatTheModelLacksIsRefused) {
  json_["candidates"][0]["effect"] = 1;
  EXPECT_THROW(read(), ConfigError);
}

TEST_F(PlanFileTest, ModelsOfOtherInputsAreRefused) {
  json_["candidates"][1]["model"]["inputs"] = {"v"};
  EXPECT_THROW(read(), ConfigError);
}

TEST_F(PlanFileTest, AnotherFileIsNoPlan) {
  json_.erase("candidates");
  EXPECT_THAT(support::refusal([&] { read(); }),
              testing::HasSubstr("want a plan, as `stillhand plan-run` writes it"));
  json_ = nlohmann::ordered_json::array();
  EXPECT_THAT(support::refusal([&] { read(); }), testing::HasSubstr("want a plan"));
}

TEST_F(PlanFileTest, OneCandidateIsNoTie) {
  json_["candidates"].erase(1);
  EXPECT_THROW(read(), ConfigError);
}

}  // namespace
}  // namespace stillhand::next_run
