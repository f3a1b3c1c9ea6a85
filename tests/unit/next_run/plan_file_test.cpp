// SPDX-License-Identifier: Apache-2.0
#include "services/files/next_run/plan_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/digest/content_digest.hpp"
#include "services/files/digest/digest.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/next_run/two_channels.hpp"

namespace stillhand::next_run::plan_file_test {

class PlanFileTest : public testing::Test {
 protected:
  PlanFileTest()
      : path_(std::filesystem::path(testing::TempDir()) / "plan_file_test" / "plan.json") {
    std::filesystem::create_directories(path_.parent_path());
    std::ofstream(path_.parent_path() / kRideName) << kRide;
    json_["seconds"] = 30.0;
    json_["ride"] = kRideName;
    json_["ride_sha256"] = digest::sha256(kRide);
    json_["candidates"] = {json_of(made::candidate("x")), json_of(made::candidate("z"))};
    json_["provenance"]["version"] = "1.2.3";
    json_["provenance"]["content_sha256"] = digest::content_digest(json_);
  }
  PlanFile read() {
    std::ofstream(path_) << json_.dump();
    return read_plan(path_, "1.2.3");
  }
  std::string refused() {
    return support::refusal([&] { read(); });
  }

  static constexpr const char* kRide = "t [s],a_y [m/s^2]\n0,1\n";

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

TEST_F(PlanFileTest, AnotherFileIsNoPlan) {
  json_.erase("candidates");
  EXPECT_THAT(support::refusal([&] { read(); }),
              testing::HasSubstr("want a plan, as `stillhand plan-run` writes it"));
  json_ = nlohmann::ordered_json::array();
  EXPECT_THAT(support::refusal([&] { read(); }), testing::HasSubstr("want a plan"));
}

TEST_F(PlanFileTest, WhatAHandChangedIsRefusedWithItsPlace) {
  const nlohmann::ordered_json whole = json_;
  const auto with = [&](const char* pointer, const nlohmann::ordered_json& value) {
    json_ = whole;
    json_[nlohmann::ordered_json::json_pointer(pointer)] = value;
    return refused();
  };
  EXPECT_NE(with("/candidates/0/effect", 1), "accepted") << "an effect that the model lacks";
  EXPECT_NE(with("/candidates/1/model/inputs", nlohmann::ordered_json::array({"v"})), "accepted");
  EXPECT_NE(with("/candidates", nlohmann::ordered_json::array({whole["candidates"][0]})),
            "accepted")
      << "one is no tie";
  using testing::HasSubstr;
  EXPECT_THAT(with("/seconds", 900.0), HasSubstr("seconds"));
  EXPECT_THAT(with("/ride", "other.csv"), HasSubstr("ride"));
  EXPECT_THAT(with("/candidates/1/kind", "tone"), HasSubstr("candidates[1].kind"));
  EXPECT_THAT(with("/candidates/1/channel", "x"), HasSubstr("candidates[1].channel"));
  EXPECT_THAT(with("/candidates/0/form", "lag"), HasSubstr("candidates[0].form"));
  EXPECT_THAT(with("/candidates/0/heldout_rmse", -1.0), HasSubstr("candidates[0].heldout_rmse"));
  EXPECT_THAT(with("/candidates/1", whole["candidates"][0]), HasSubstr("another cause"));
  EXPECT_THAT(with("/provenance/version", "1.2.4"), HasSubstr("plan the run again"));
  // What no field shows, the digest does.
  EXPECT_THAT(with("/candidates/0/heldout_rmse", 0.5), HasSubstr("changed after it was written"));
}

TEST_F(PlanFileTest, AnotherRideIsRefused) {
  std::ofstream(path_.parent_path() / kRideName) << "t [s],a_y [m/s^2]\n0,2\n";
  EXPECT_THAT(refused(), testing::HasSubstr("not the ride of this plan"));
  std::filesystem::remove(path_.parent_path() / kRideName);
  EXPECT_THAT(refused(), testing::HasSubstr("the ride next to its plan"));
}

}  // namespace stillhand::next_run::plan_file_test
