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

double settled_after_s(const cancellation::ControlModel& model,
                       const std::filesystem::path& config) {
  const auto settings =
      settings::load<cancellation::Config>(config / "cancellation.yaml", "cancellation");
  const cancellation::ModelCheck check =
      cancellation::check_model(model, cancellation::bounds(settings));
  return kControlPeriod_s *
         static_cast<double>(kModelNotice_ticks + check.settle_ticks + settings.fade_ticks);
}

}  // namespace stillhand::lab
