// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/subject_settings.hpp"

#include <gtest/gtest.h>

#include "places.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/human_operator/subject_config.hpp"
#include "services/core/population/population.hpp"
#include "services/core/rig/rig.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/yaml_text.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::lab::subject_settings_test {
namespace {

const std::filesystem::path kConfig = std::filesystem::path(STILLHAND_SOURCE) / "deploy/config";

TEST(SubjectSettingsTest, RigAndOperatorAreTheSubjectThatTheStudyDraws) {
  const support::Folder folder;
  const auto to = folder / "subject_settings";
  write_subject_settings(kConfig, to, 7, 3);
  const population::Subject drawn = population::draw_subject({}, 7, 2);
  const auto rig = settings::load<rig::RigConfig>(to / "rig.yaml", "rig");
  const auto person =
      settings::load<human_operator::SubjectConfig>(to / "human_operator.yaml", "human_operator");
  EXPECT_EQ(rig.body.shoulder_stiffness_n_m, drawn.body.shoulder_stiffness_n_m);
  EXPECT_EQ(settings::yaml_text(rig.body), settings::yaml_text(drawn.body));
  EXPECT_EQ(settings::yaml_text(rig.stick), settings::yaml_text(rig::StickConfig{}));
  EXPECT_EQ(settings::yaml_text(person.crossover), settings::yaml_text(drawn.who));
  EXPECT_EQ(person.pointer.arm.effective_stiffness_n_m, drawn.who.arm.effective_stiffness_n_m);
  for (const auto& entry : std::filesystem::directory_iterator(kConfig)) {
    EXPECT_TRUE(std::filesystem::exists(to / entry.path().filename())) << entry.path();
  }
  EXPECT_EQ(recording::read_file((to / "motion.yaml").string()),
            recording::read_file((kConfig / "motion.yaml").string()));
}

TEST(SubjectSettingsTest, WhatNoPopulationDrawsStaysAndTheFeelIsThatOfTheStick) {
  const support::Folder folder;
  const auto write = [&](const char* name, const std::string& text) {
    ASSERT_TRUE(recording::write_file_atomically((folder / name).string(), text).ok());
  };
  write("rig.yaml",
        "body:\n  arm_rest_stiffness_n_m: 50\n  neuromuscular:\n    wander_time_s: 7\n"
        "stick:\n  centring_stiffness_n_m: 500\n");
  write("human_operator.yaml",
        "crossover:\n  arm:\n    max_force_n: 11\npointer:\n  arm:\n    max_force_n: 12\n");
  write_subject_settings(folder, folder / "own", 7, 3);
  const auto rig = settings::load<rig::RigConfig>(folder / "own" / "rig.yaml", "rig");
  const auto person = settings::load<human_operator::SubjectConfig>(
      folder / "own" / "human_operator.yaml", "human_operator");
  EXPECT_EQ(rig.body.arm_rest_stiffness_n_m, 50.0);
  EXPECT_EQ(rig.body.neuromuscular.wander_time_s, 7.0);
  EXPECT_EQ(person.crossover.arm.max_force_n, 11.0);
  EXPECT_EQ(person.pointer.arm.max_force_n, 12.0);
  const double plain_n_m =
      population::learnt_feel(rig.body, rig::StickConfig{}).effective_stiffness_n_m;
  EXPECT_NEAR(person.crossover.arm.effective_stiffness_n_m, plain_n_m + 500.0, 1e-6);
  EXPECT_EQ(person.pointer.arm.effective_stiffness_n_m,
            person.crossover.arm.effective_stiffness_n_m);
}

TEST(SubjectSettingsTest, ASettingsFolderWithoutTheRigIsRefused) {
  const std::filesystem::path to = std::filesystem::path(testing::TempDir()) / "nothing_here";
  EXPECT_THROW(write_subject_settings(to, to / "config", 1, 1), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(to));
}

}  // namespace
}  // namespace stillhand::lab::subject_settings_test
