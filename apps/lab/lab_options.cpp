// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/lab_options.hpp"

#include "services/files/settings/load.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::lab {

void set_places(LabOptions& options) {
  options.programs = runtime::prefix() / "bin";
  options.profiles = runtime::shipped("qos/profiles.xml");
  options.config = runtime::shipped("deploy/config");
}

cancellation::Config canceller_config(const LabOptions& options) {
  auto config =
      settings::load<cancellation::Config>(options.config / "cancellation.yaml", "cancellation");
  // As the process does: without the word its settings hold.
  if (options.canceller != "now") config.sampling = cancellation::sampling_named(options.canceller);
  return config;
}

}  // namespace stillhand::lab
