// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "apps/lab/session_figure.hpp"
#include "apps/lab/session_page.hpp"
#include "apps/lab/summary_json.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/files/identification/model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/load.hpp"
#include "services/messages/identification/codec.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::lab {
namespace {

void print_tables(const session::SessionResult& result) {
  if (trial_of(result, session::Condition::kP) != nullptr) {
    std::printf("`stillhand identify session.mcap --admittance` reads the perturbed trial\n");
    return;
  }
  std::printf("\n%s`stillhand close-the-loop --repeats` measures an interval.\n",
              report::in_plain_text(metrics_table(result)).c_str());
  if (mitigated_trials(result).empty()) return;
  std::printf("\n%s", report::in_plain_text(mitigations_table(result)).c_str());
}

void print_disturbances(const session::SessionResult& result) {
  for (const std::string& line : disturbance_lines(result)) std::printf("%s\n", line.c_str());
}

void print_model_changes(const std::vector<session::TrialOutcome>& outcomes) {
  for (const std::string& line : model_change_lines(outcomes)) std::printf("%s\n", line.c_str());
}

void print_budgets(const session::SessionResult& result) {
  for (const session::TrialResult& trial : result.trials) {
    if (!trial.budget) continue;
    std::string parts;
    for (const session::ForceCause& cause : session::kForceCauses) {
      const double force_n = ((*trial.budget).*cause.of).force_n;
      parts +=
          fmt::format("{}{} {}", parts.empty() ? "" : ", ", cause.key, report::number(force_n, 2));
    }
    fmt::print("{} leaves {} N RMS of the feedthrough force; by cause [N]: {}\n",
               name_in(result, trial), report::number(trial.budget->left.force_n, 2), parts);
  }
}

void print_rig(const LabOptions& options) {
  if (options.devices.empty()) return;
  const auto devices = settings::load<device_rig::DevicesConfig>(options.devices, "devices");
  std::printf("rig: %s\n", device_rig::in_words(devices.signals).c_str());
}

void print_models(const session::SessionResult& result,
                  const std::filesystem::path& control_model) {
  if (result.model && result.model->usable()) {
    std::printf("feedthrough model: VAF on held-out pegged data %.2f %%\n",
                result.model->heldout_vaf_percent());
  } else if (result.model) {
    std::printf("no usable feedthrough model: %s\n", result.model->text().c_str());
  }
  if (!control_model.empty()) std::printf("C ran %s instead\n", control_model.c_str());
  for (const session::TrialResult& trial : result.trials) {
    if (session::cancels(trial.label) && std::isfinite(trial.cancelled_share)) {
      std::printf("%s cancels %.1f %% of the feedthrough force, which the simulated rig knows\n",
                  name_in(result, trial).c_str(), 100.0 * trial.cancelled_share);
    }
    if (trial.sensed_share) {
      std::printf(
          "%s removes %.0f %% (95 %%: %.0f to %.0f) of the stick's motion that the seat causes in "
          "B, from the sensors alone\n",
          session::name_of(trial.label), 100.0 * trial.sensed_share->share,
          100.0 * trial.sensed_share->low, 100.0 * trial.sensed_share->high);
    }
  }
  if (result.conversion) {
    std::printf(
        "in a tracking trial, the model of the relaxed arm misses %.1f %% of the feedthrough "
        "force\n",
        100.0 * result.conversion->control_filter);
  }
}

// A ride and a road have an intensity of their own, which the user does not choose.  It is the same
// in every trial.
void print_motion(const std::vector<session::TrialOutcome>& outcomes,
                  const session::ProtocolOptions& protocol) {
  for (const session::TrialOutcome& outcome : outcomes) {
    if (!outcome.asked || outcome.planned.motion == motion::MotionKind::kBandNoise ||
        outcome.planned.motion == motion::MotionKind::kMultisine) {
      continue;
    }
    const motion::MotionReport& asked = *outcome.asked;
    if (outcome.planned.motion == motion::MotionKind::kRide) {
      std::printf(
          "ride: high-pass at %.3f Hz, %.1f %% of its variance removed (%.1f %% by the high-pass)",
          asked.corner_hz, 100.0 * asked.removed_share, 100.0 * asked.removed_slow_share);
    } else {
      std::printf("road: class %s at %.1f m/s", protocol.road_class.c_str(),
                  protocol.road_speed_m_s);
    }
    std::printf(", RMS %.2f m/s^2, largest displacement %.0f mm\n", asked.rms_m_s2,
                1000.0 * asked.peak_position_m);
    return;
  }
}

void write(const std::filesystem::path& path, const std::string& text) {
  const recording::Status status = recording::write_file_atomically(path.string(), text);
  if (!status.ok()) throw std::runtime_error(path.string() + ": " + status.text);
}

// A picture is worth a line, not the session's results.
void draw(const LabOptions& options, const std::vector<session::TrialOutcome>& outcomes,
          const session::SessionResult& result) {
  if (result.trials.empty()) return;
  try {
    session_page(options, outcomes, result, draw_session(result, options.out))
        .write(options.out / kSessionPage);
  } catch (const std::exception& error) {
    runtime::remark(std::string(kSessionFigure) + ".png is not drawn: " + error.what());
  }
}

}  // namespace

int report_session(const LabOptions& options, std::vector<session::TrialOutcome> outcomes,
                   bool interrupted) {
  session::SessionResult result =
      evaluate((options.out / "session.mcap").string(), outcomes, answers_of(options));
  for (session::TrialOutcome& outcome : outcomes) {
    const auto why = result.unrecorded.find(outcome.planned.trial.number);
    if (why == result.unrecorded.end()) continue;
    outcome.completed = false;
    outcome.aborted = why->second;
  }
  // Under a vehicle the acceleration follows the stick: Eq. SN-7 would show the vehicle.
  if (!options.vehicle.empty()) {
    for (session::TrialResult& trial : result.trials) trial.sensed_share.reset();
  }
  if (result.model && result.model->usable()) {
    write(options.out / "model.json",
          identification::model_json(identification::from_idl(*result.model)));
  }
  write(options.out / "summary.json",
        summary_json(options, outcomes, result, interrupted).dump(2) + "\n");
  draw(options, outcomes, result);
  print_tables(result);
  print_disturbances(result);
  print_model_changes(outcomes);
  print_budgets(result);
  print_rig(options);
  print_models(result, options.model);
  print_motion(outcomes, options.protocol);
  std::int64_t lost = 0;
  for (const auto& [topic, count] : result.lost_ticks) lost += count;
  std::printf("lost ticks on the 1 kHz topics: %lld\n", static_cast<long long>(lost));
  std::printf("results in %s\n", options.out.string().c_str());
  report::say_open(options.out / kSessionPage);
  if (!result.disturbances.empty()) {
    report::say_next("stillhand misses " + report::quoted_for_shell(options.out / "session.mcap") +
                     " --picture late.svg");
  }
  const std::vector<std::string> uncounted = uncounted_lines(outcomes);
  for (const std::string& line : uncounted) runtime::remark(line);
  const bool whole = std::ranges::all_of(
      outcomes, [](const auto& outcome) { return outcome.completed || outcome.stopped; });
  return whole && !interrupted ? 0 : 1;
}

}  // namespace stillhand::lab
