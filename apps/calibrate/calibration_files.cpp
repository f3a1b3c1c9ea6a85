// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/calibration_files.hpp"

#include <fmt/format.h>

#include <iostream>
#include <string>

#include "apps/libraries/report/result_files.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/edit_text.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::calibrate {
void write_calibrations(const std::filesystem::path& config, const device_rig::Calibrations& all,
                        const std::vector<device_rig::SensingNumber>& numbers) {
  const auto sensing_file = config / "sensing.yaml";
  const auto file = config / "calibration.yaml";
  std::string sensing = recording::text_of(sensing_file);
  for (const auto& number : numbers) {
    sensing = settings::with_setting(std::move(sensing), number.key,
                                     fmt::format("{}", number.calibrated));
  }
  // Its numbers must be ones that sensing accepts.
  settings::load_text<sensing::Config>(sensing, "sensing", "calibration");
  const std::string calibrations =
      "# Written by `stillhand calibrate`; services/core/device_rig/METHOD.md, Eq. DR-16.\n" +
      settings::yaml_text(all);
  settings::load_text<device_rig::Calibrations>(calibrations, "calibration", "calibration");
  if (numbers.empty()) {
    report::ResultFiles files({{"calibration.yaml", file}}, {});
    files.set("calibration.yaml", calibrations);
    files.publish();
    std::cout << "wrote " << file.string() << '\n';
    return;
  }
  report::ResultFiles files({{"sensing.yaml", sensing_file}, {"calibration.yaml", file}}, {});
  files.set("sensing.yaml", sensing);
  files.set("calibration.yaml", calibrations);
  files.publish();
  std::cout << "wrote " << sensing_file.string() << " and " << file.string() << '\n';
}

}  // namespace stillhand::calibrate
