// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/verdict/control_model.hpp"
#include "apps/close_the_loop/verdict/drive.hpp"
#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::close_the_loop {

/// [s] A shorter delay is none: the stick's own equation does not distinguish it.
inline constexpr double kWorthLatency_s = 0.005;

/// Where an effect acts, as far as a verdict says.
inline constexpr const char* kBody = "body";
inline constexpr const char* kDrive = "drive";
inline constexpr const char* kMotorPath = "motor path";
inline constexpr const char* kLoadCell = "load cell";

/// What a verdict concludes.
inline constexpr const char* kFound = "effects found";
inline constexpr const char* kUnexplained = "unexplained residual";
inline constexpr const char* kNothing = "nothing missing";
inline constexpr const char* kNoModel = "no model";

/// The recordings that a verdict is made from; it uses nothing else of the rig.
struct Evidence {
  const diagnosis::Measurement* pegged = nullptr;  ///< identification: inputs to output
  /// B, 1 kHz: the stick's own equation; none: the drive is not diagnosed.
  std::vector<const recording::Recording*> moving = {};
  /// C, or the newest C+, 1 kHz: the motor's too; none: no latency is measured.
  std::vector<const recording::Recording*> cancelled = {};
  /// The motor acts in the same session, so that a tone's phase and a gain over time go on.
  bool session_goes_on = true;
};

/// One effect that the paper's model lacks.
struct Finding {
  std::string kind;
  std::string channel;       ///< empty: none
  std::string where;         ///< kBody, kDrive, kMotorPath or kLoadCell
  double explained_n = 0.0;  ///< RMS force
  double before_n = 0.0;     ///< held-out error before and after, where it was found
  double after_n = 0.0;
  std::string evidence;
  std::optional<std::pair<double, double>> interval95 = {};  ///< of explained_n; none of a delay
  bool counts = true;  ///< explained_n is at least what the options ask for
};

/// What is missing, and what the canceller does about it.
struct Verdict {
  diagnosis::Diagnosis body;                  ///< of the pegged trial, load cell's delay taken off
  std::optional<diagnosis::Diagnosis> drive;  ///< of the stick's own equation
  std::optional<Latency> latency;
  bool cell_is_late = false;      ///< the latency is the load cell's, and large enough to count
  std::vector<Finding> findings;  ///< those that count first, then strongest first
  ConvertedModel control;
  std::string not_carried;  ///< why there is no control model, or empty

  /// The strongest that counts; null: none does.
  [[nodiscard]] const Finding* strongest() const {
    return findings.empty() || !findings.front().counts ? nullptr : &findings.front();
  }
  /// Its kind, or "none".
  [[nodiscard]] std::string kind() const {
    return strongest() == nullptr ? std::string("none") : strongest()->kind;
  }
  /// Of the body, with its effects if one of them counts.
  [[nodiscard]] const diagnosis::Model& model() const {
    return body.has_effect_that_counts() ? body.model : body.baseline.model;
  }
  /// The part of it that predicts other recordings and that the canceller is given.
  [[nodiscard]] diagnosis::CarriedModel carried() const {
    return body.effects.empty() || body.has_effect_that_counts()
               ? body.carried
               : diagnosis::carried_as_it_is(body.baseline.model);
  }
  /// kFound, kUnexplained, kNoModel or kNothing.
  [[nodiscard]] std::string conclusion() const;
};

/// [N] RMS force from which on a verdict can name an effect: from which it counts, and is found as
/// often as not (diagnosis, Eq. DG-62).
double detectable_n(const Verdict& verdict, bool in_drive);

/// What the canceller does about the drive's effects that count.
void add_drive_effects(const diagnosis::Diagnosis& drive, ConvertedModel& to);

/// A record with the output as if its sensor were not late; the last samples of a stretch then
/// count as not measured.  @param seconds  [s] delay of the sensor
diagnosis::Measurement advanced(const diagnosis::Measurement& record, const std::string& output,
                                double seconds);

/// Diagnoses body, drive and latency, and makes the canceller's model from them, METHOD "The
/// verdict".
/// @param options  of the body, as `stillhand diagnose` takes them; the drive has a model of its
/// own
/// @throws ConfigError when a recording cannot be diagnosed
Verdict diagnose_all(const Evidence& evidence, const DeclaredDrive& declared,
                     const diagnosis::DiagnoseOptions& options);

}  // namespace stillhand::close_the_loop
