// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/pause_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <string>

#include "apps/lab/control_model.hpp"
#include "apps/lab/output_folder.hpp"
#include "apps/lab/processes.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::lab {
namespace {

constexpr double kDiagnosis_s = 180.0;
constexpr double kDiagnosisEnds_s = 1.0;

std::filesystem::path folder_of(const LabOptions& options) { return options.out / kClosingFolder; }

// The verb that a person would start after the session, below every process of the session.  It
// ends with the lab, whatever ended that.
Launch diagnosis_of(const LabOptions& options) {
  Launch launch;
  launch.name = "diagnosis";
  launch.executable = "setpriv";
  launch.log = options.out / "logs" / "closing.log";
  launch.arguments = {"--pdeathsig",
                      "KILL",
                      "nice",
                      "-n",
                      "10",
                      (options.programs / "stillhand").string(),
                      "close-the-loop",
                      "--pegged",
                      (options.out / "session.mcap").string(),
                      "--rig",
                      fmt::to_string(options.rig),
                      "--threads",
                      fmt::to_string(std::max(1u, runtime::core_count() / 2)),
                      "--out",
                      folder_of(options).string()};
  return launch;
}

}  // namespace

PauseVerdict diagnose_in_pause(const LabOptions& options, LiveTrials& trials) {
  Processes processes;
  std::optional<Ended> ended;
  try {
    processes.start(diagnosis_of(options));
    trials.rest("diagnosis of the identification", kDiagnosis_s, [&] {
      if (!ended) ended = processes.reap();
      return ended.has_value();
    });
    if (!ended) {
      processes.end("diagnosis", kDiagnosisEnds_s);
      return {.why_not = "its diagnosis was not ready"};
    }
    if (ended->exit_status != 0) return {.why_not = describe(*ended)};
    return pause_verdict(recording::read_file((folder_of(options) / "summary.json").string()));
  } catch (const std::exception& error) {
    return {.why_not = std::string("it was not diagnosed: ") + error.what()};
  }
}

cancellation::ControlModel diagnosed_model(const LabOptions& options) {
  cancellation::ControlModel plus =
      control_model(folder_of(options) / "control_model.json", options.rig, options.config);
  plus.adapts.reset();
  return plus;
}

}  // namespace stillhand::lab
