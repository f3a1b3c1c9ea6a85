// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/arms_file.hpp"

#include <string>

#include "services/core/cancellation/parts/linear_arm.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::lab {

admittance::ArmValues read_arm(const std::filesystem::path& file) {
  const auto json = settings::parsed_json(recording::read_file(file.string()), file.string(),
                                          "JSON of stillhand identify --admittance --json");
  const settings::JsonEntry parameters =
      settings::JsonEntry(json, file.string()).at("arm").at("parameters");
  admittance::ArmValues arm{};
  for (std::size_t p = 0; p < arm.size(); ++p) {
    const std::string name(admittance::arm_parameter_names()[p].name);
    arm[p] = parameters.at(name).at("value").number();
  }
  try {
    const cancellation::LinearArm sound(arm, {});
  } catch (const ConfigError& error) {
    throw ConfigError(file.string(), error.what(), "an arm that is stable");
  }
  return arm;
}

std::vector<double> schedule_values(const std::vector<std::filesystem::path>& files) {
  if (files.size() != 2) {
    throw ConfigError("--arms", std::to_string(files.size()) + " files",
                      "two of stillhand identify --admittance --json: relaxed, then holding");
  }
  std::vector<double> values;
  for (const std::filesystem::path& file : files) {
    const admittance::ArmValues arm = read_arm(file);
    values.insert(values.end(), arm.begin(), arm.end());
  }
  return values;
}

}  // namespace stillhand::lab
