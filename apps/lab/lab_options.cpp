// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/lab_options.hpp"

#include "services/system/process/shipped.hpp"

namespace stillhand::lab {

void set_places(LabOptions& options) {
  options.programs = runtime::prefix() / "bin";
  options.profiles = runtime::shipped("qos/profiles.xml");
  options.config = runtime::shipped("deploy/config");
}

}  // namespace stillhand::lab
