// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/answer_settings.hpp"

#include "services/core/rig/rig.hpp"
#include "services/files/settings/load.hpp"

namespace stillhand::session {

AnswerConfigs load_answers(const std::filesystem::path& config) {
  const auto rig = settings::load<rig::RigConfig>(config / "rig.yaml", "rig");
  return {settings::load<sensing::Config>(config / "sensing.yaml", "sensing"),
          settings::load<cancellation::Config>(config / "cancellation.yaml", "cancellation"),
          rig.motor, rig.stick.lever_m};
}

}  // namespace stillhand::session
