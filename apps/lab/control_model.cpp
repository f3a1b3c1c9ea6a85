// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/control_model.hpp"

#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/load.hpp"

namespace stillhand::lab {

cancellation::ControlModel control_model(const std::filesystem::path& file, std::uint32_t rig,
                                         const std::filesystem::path& config) {
  auto model =
      cancellation::parse_control_model(recording::read_file(file.string()), file.string(), rig);
  cancellation::require_sound(
      model, settings::load<cancellation::Config>(config / "cancellation.yaml", "cancellation"),
      file.string());
  return model;
}

}  // namespace stillhand::lab
