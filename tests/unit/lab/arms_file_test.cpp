// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/arms_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "services/core/admittance/arm_fit.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::lab::arms_file_test {
namespace {

nlohmann::json json_of(const admittance::ArmValues& arm) {
  nlohmann::json parameters;
  for (std::size_t p = 0; p < arm.size(); ++p) {
    parameters[std::string(admittance::arm_parameter_names()[p].name)] = {{"value", arm[p]}};
  }
  return {{"arm", {{"parameters", parameters}}}};
}

std::filesystem::path file_of(const std::string& name, const nlohmann::json& json) {
  const std::filesystem::path path = testing::TempDir() + "arms_file_" + name;
  std::ofstream(path) << json;
  return path;
}

std::string refusal(const std::vector<std::filesystem::path>& files) {
  return support::refusal([&] { (void)schedule_values(files); });
}

TEST(ArmsFileTest, TheRelaxedArmComesFirst) {
  admittance::ArmValues soft = admittance::mean_arm();
  soft[admittance::kArmStiffness] = 700.0;
  const auto values = schedule_values(
      {file_of("soft", json_of(soft)), file_of("stiff", json_of(admittance::mean_arm()))});
  ASSERT_EQ(values.size(), 2 * admittance::kArmParameters);
  EXPECT_EQ(values[admittance::kArmStiffness], 700.0);
  EXPECT_EQ(values[admittance::kArmParameters + admittance::kArmStiffness],
            admittance::mean_arm()[admittance::kArmStiffness]);
}

TEST(ArmsFileTest, WhatIsNoArmIsRefusedAndNamed) {
  const auto good = file_of("good", json_of(admittance::mean_arm()));
  EXPECT_THAT(refusal({good}), testing::HasSubstr("--arms: got 1 files"));
  nlohmann::json lacking = json_of(admittance::mean_arm());
  lacking["arm"]["parameters"].erase(
      std::string(admittance::arm_parameter_names()[admittance::kGripDamping].name));
  EXPECT_THAT(refusal({good, file_of("lacking", lacking)}),
              testing::HasSubstr("arms_file_lacking"));
  admittance::ArmValues weightless = admittance::mean_arm();
  weightless[admittance::kArmMass] = 0.0;
  EXPECT_THAT(refusal({good, file_of("weightless", json_of(weightless))}),
              testing::HasSubstr("stable"));
}

}  // namespace
}  // namespace stillhand::lab::arms_file_test
