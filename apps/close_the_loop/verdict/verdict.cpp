// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/close_the_loop/verdict/drive_effects.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::close_the_loop {
namespace {

// Of the friction that was found: the rest keeps the stick from hunting.
constexpr double kFrictionShare = 0.8;

Finding finding_of(const diagnosis::FoundEffect& effect, const char* where,
                   const std::string& unit) {
  return {effect.effect.kind,
          effect.channel,
          where,
          effect.explained.rms,
          effect.before.rmse,
          effect.after.rmse,
          diagnose::shown_sentence(effect.evidence, unit),
          std::pair{effect.explained.low, effect.explained.high},
          effect.counts};
}

// The latest of several recordings: the median would hide a drive that is late now and then.
std::optional<Latency> latest(const std::vector<const recording::Recording*>& cancelled,
                              const DeclaredDrive& declared) {
  std::optional<Latency> out;
  for (const recording::Recording* each : cancelled) {
    const auto measured = measure_latency(*each, declared);
    const auto sum = [](const Latency& latency) { return latency.motor_s + latency.cell_s; };
    if (measured && (!out || sum(*measured) > sum(*out))) out = measured;
  }
  return out;
}

// What the hand does not feel is the load cell's alone.
const char* place_of(const diagnosis::Effect& effect) {
  const auto role = diagnosis::effect_kind(effect.kind).body_role(effect);
  return std::holds_alternative<diagnosis::control::NotFelt>(role) ? kLoadCell : kBody;
}

std::string milliseconds(double seconds) { return fmt::format("{:.0f} ms", 1e3 * seconds); }

std::optional<Finding> latency_finding(const std::optional<Latency>& latency,
                                       const DeclaredDrive& declared, double least_force_n) {
  if (!latency) return std::nullopt;
  const double motor_s = latency->motor_s - declared.motor_delay_s;
  const bool of_cell = latency->cell_s > motor_s;
  const double late_s = std::max(latency->cell_s, motor_s);
  if (late_s < kWorthLatency_s) return std::nullopt;
  const double before = std::hypot(latency->residual_n, latency->explained_n);
  return Finding{std::string(diagnosis::delay_kind().name()),
                 "",
                 of_cell ? kLoadCell : kMotorPath,
                 latency->explained_n,
                 before,
                 latency->residual_n,
                 std::string(of_cell ? "the load cell reports a force " : "the motor acts ") +
                     milliseconds(late_s) + (of_cell ? " late" : " later than declared") +
                     ", by the stick's own equation",
                 {},
                 latency->explained_n >= least_force_n};
}

void add_drive_findings(Verdict& out) {
  for (const diagnosis::FoundEffect& effect : out.drive->effects) {
    out.findings.push_back(finding_of(effect, kDrive, "N"));
  }
  if (out.not_carried.empty()) add_drive_effects(*out.drive, out.control);
}

}  // namespace

void add_drive_effects(const diagnosis::Diagnosis& drive, ConvertedModel& to) {
  for (const diagnosis::FoundEffect& effect : drive.effects) {
    if (effect.counts) add_drive_effect(effect.effect, kFrictionShare, to);
  }
}

diagnosis::Measurement advanced(const diagnosis::Measurement& record, const std::string& output,
                                double seconds) {
  diagnosis::Measurement out = record;
  const auto late = static_cast<std::size_t>(std::lround(seconds * record.rate_hz));
  const auto channel = std::ranges::find(out.channels, output, &diagnosis::Channel::name);
  if (late == 0 || channel == out.channels.end()) return out;
  for (const diagnosis::Stretch& stretch : out.stretches) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      const bool known = n + late < stretch.end;
      channel->values[n] = channel->values[known ? n + late : stretch.end - 1];
      out.weight[n] = known ? out.weight[n + late] : 0.0;
    }
  }
  return out;
}

double detectable_n(const Verdict& verdict, bool in_drive) {
  const diagnosis::Diagnosis& of = in_drive && verdict.drive ? *verdict.drive : verdict.body;
  return std::max(of.options.least_force_n, of.detection_limit);
}

std::string Verdict::conclusion() const {
  if (strongest() != nullptr) return kFound;
  for (const char* other : {kUnexplained, kNoModel}) {
    if (body.verdict() == other) return other;
  }
  return kNothing;
}

Verdict diagnose_all(const Evidence& evidence, const DeclaredDrive& declared,
                     const diagnosis::DiagnoseOptions& options) {
  Verdict out;
  out.latency = latest(evidence.cancelled, declared);
  const auto late = latency_finding(out.latency, declared, options.least_force_n);
  if (late) out.findings.push_back(*late);
  const bool cell_late = late && late->where == kLoadCell;
  out.cell_is_late = cell_late;

  const diagnosis::Measurement measurement =
      advanced(*evidence.pegged, options.output, cell_late ? out.latency->cell_s : 0.0);
  out.body = diagnosis::diagnose(measurement, options);
  for (const diagnosis::FoundEffect& effect : out.body.effects) {
    out.findings.push_back(finding_of(effect, place_of(effect.effect), out.body.output_unit));
  }
  const diagnosis::Signals signals(diagnosis::working_set(measurement, options.inputs),
                                   options.inputs, options.output);
  ControlOptions control;
  control.lead_s = out.latency ? out.latency->motor_s : declared.motor_delay_s;
  try {
    diagnosis::CarriedModel carried = out.carried();
    if (!evidence.session_goes_on) carried.in_session = carried.model;
    out.control = to_control_model(carried, signals, control);
  } catch (const ConfigError& error) {
    out.not_carried = error.what();
  }

  if (!evidence.moving.empty()) {
    out.drive = diagnose_drive(evidence.moving, declared, options);
    // A late cell distorts the stick's equation; it is among the findings already.
    if (!cell_late) add_drive_findings(out);
  }
  std::ranges::stable_sort(out.findings, std::ranges::greater{}, [](const Finding& finding) {
    return std::pair(finding.counts, finding.explained_n);
  });
  return out;
}

}  // namespace stillhand::close_the_loop
