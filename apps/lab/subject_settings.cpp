// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/subject_settings.hpp"

#include <string>

#include "services/core/display/tracking_display.hpp"
#include "services/core/human_operator/subject_config.hpp"
#include "services/core/population/population.hpp"
#include "services/core/population/task.hpp"
#include "services/core/rig/rig.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::lab {
namespace {

void copy_settings(const std::filesystem::path& config, const std::filesystem::path& to) {
  std::filesystem::create_directories(to);
  if (std::filesystem::equivalent(config, to)) return;
  for (const auto& entry : std::filesystem::directory_iterator(config)) {
    if (entry.path().extension() != ".yaml") continue;
    recording::write_file(to / entry.path().filename(),
                          recording::read_file(entry.path().string()));
  }
}

}  // namespace

void write_perturbed_settings(const std::filesystem::path& config, const std::filesystem::path& to,
                              const std::string& task) {
  auto rig = settings::load<rig::RigConfig>(config / "rig.yaml", "rig");
  auto screen =
      settings::load<display::TrackingDisplay::Config>(config / "display.yaml", "display");
  rig.body = population::doing(rig.body, population::task_from(task));
  screen.reference_scale_m = 0.0;
  copy_settings(config, to);
  recording::write_file(to / "rig.yaml", settings::yaml_text(rig));
  recording::write_file(to / "display.yaml", settings::yaml_text(screen));
}

void write_subject_settings(const std::filesystem::path& config, const std::filesystem::path& to,
                            std::uint64_t seed, std::int64_t subject) {
  auto rig = settings::load<rig::RigConfig>(config / "rig.yaml", "rig");
  auto person = settings::load<human_operator::SubjectConfig>(config / "human_operator.yaml",
                                                              "human_operator");
  const population::Subject drawn =
      population::draw_subject({}, seed, subject - 1, {rig.body, person.crossover}, rig.stick);
  rig.body = drawn.body;
  person.crossover = drawn.who;
  person.pointer.arm = population::learnt_feel(rig.body, rig.stick, person.pointer.arm);
  copy_settings(config, to);
  recording::write_file(to / "rig.yaml", settings::yaml_text(rig));
  recording::write_file(to / "human_operator.yaml", settings::yaml_text(person));
}

}  // namespace stillhand::lab
