// SPDX-License-Identifier: Apache-2.0
// Every settings file of deploy/ shows every key of its Config with the default that it has: with
// the comment marks taken away, it reads as that Config's defaults and leaves none out.
#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "apps/dashboard/core/config.hpp"
#include "places.hpp"
#include "services/core/cancellation/config.hpp"
#include "services/core/device_rig/devices_config.hpp"
#include "services/core/display/tracking_display.hpp"
#include "services/core/human_operator/subject_config.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/population/population.hpp"
#include "services/core/rig/rig.hpp"
#include "services/core/sensing/conditioner.hpp"
#include "services/core/vehicle/vehicle_settings.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::settings_test {
namespace {

// What stands below the file's first, explaining paragraph, its lines taken out of their comments.
std::string uncommented(const std::string& file) {
  std::istringstream lines(recording::read_file(std::string(STILLHAND_SOURCE) + "/deploy/" + file));
  std::string text;
  bool explained = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) explained = true;
    if (explained && line.starts_with("# ")) text += line.substr(2) + "\n";
  }
  return text;
}

// Keys that the text sets, by its indentation of two blanks a group.
std::set<std::string> keys_of(const std::string& yaml) {
  std::set<std::string> keys;
  std::vector<std::string> groups;
  std::istringstream lines(yaml);
  for (std::string line; std::getline(lines, line);) {
    const auto indent = line.find_first_not_of(' ');
    const auto colon = line.find(':');
    if (indent == std::string::npos || line[indent] == '#' || colon == std::string::npos) continue;
    groups.resize(indent / 2);
    std::string path;
    for (const std::string& group : groups) path += group + ".";
    const std::string key = line.substr(indent, colon - indent);
    keys.insert(path + key);
    groups.push_back(key);
  }
  return keys;
}

template <typename Config>
void expect_in_step(const std::string& file) {
  const std::string text = uncommented(file);
  ASSERT_FALSE(text.empty()) << file;
  const Config defaults;
  EXPECT_EQ(settings::yaml_text(settings::load_text<Config>(text, file)),
            settings::yaml_text(defaults))
      << file;
  const std::set<std::string> shown = keys_of(text);
  for (const std::string& name : keys_of(settings::yaml_text(defaults))) {
    EXPECT_TRUE(shown.contains(name)) << file << " lacks " << name;
  }
}

TEST(DeployedSettingsTest, EveryFileShowsEveryKeyWithItsDefault) {
  expect_in_step<rig::RigConfig>("config/rig.yaml");
  expect_in_step<device_rig::DevicesConfig>("config/devices.yaml");
  expect_in_step<sensing::Config>("config/sensing.yaml");
  expect_in_step<motion::MotionGenerator::Config>("config/motion.yaml");
  expect_in_step<vehicle::VehicleSettings>("config/vehicle.yaml");
  expect_in_step<cancellation::Config>("config/cancellation.yaml");
  expect_in_step<display::TrackingDisplay::Config>("config/display.yaml");
  expect_in_step<human_operator::SubjectConfig>("config/human_operator.yaml");
  expect_in_step<identification::Config>("config/identification.yaml");
  expect_in_step<dashboard::Config>("config/dashboard.yaml");
  expect_in_step<population::Population>("experiments/population.yaml");
}

}  // namespace
}  // namespace stillhand::settings_test
