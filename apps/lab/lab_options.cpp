// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/lab_options.hpp"

#include "apps/libraries/session/answer_settings.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/next_run/plan_file.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/process/remark.hpp"
#include "services/system/process/shipped.hpp"
#include "version.hpp"

namespace stillhand::lab {

void set_places(LabOptions& options) {
  options.programs = runtime::prefix() / "bin";
  options.profiles = runtime::shipped("qos/profiles.xml");
  options.config = runtime::shipped("deploy/config");
}

void take_plan(const std::filesystem::path& path, LabOptions& options) {
  const next_run::PlanFile plan = next_run::read_plan(path, kVersion);
  options.protocol.planned = true;
  options.protocol.conditions.clear();
  options.protocol.identify_s = plan.seconds;
  options.ride = plan.ride;
}

cancellation::Config canceller_config(const LabOptions& options) {
  auto config =
      settings::load<cancellation::Config>(options.config / "cancellation.yaml", "cancellation");
  // As the process does: without the word its settings hold.
  if (options.canceller != "now") config.sampling = cancellation::sampling_named(options.canceller);
  return config;
}

std::optional<session::AnswerConfigs> answers_of(const LabOptions& options) try {
  if (!options.devices.empty()) return std::nullopt;
  session::AnswerConfigs answers = session::load_answers(options.config);
  answers.cancellation = canceller_config(options);
  return answers;
} catch (const ConfigError& error) {
  runtime::remark(std::string("what C leaves is not split into causes: ") + error.what());
  return std::nullopt;
}

}  // namespace stillhand::lab
