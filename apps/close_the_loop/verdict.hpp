// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/close_the_loop/control_model.hpp"
#include "apps/close_the_loop/drive.hpp"
#include "services/diagnosis/core/diagnose.hpp"
#include "services/recording/core/recording.hpp"

namespace stillhand::close_the_loop {

/// [s] A shorter delay does not move a hand.
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

/// The recordings that a verdict is made from; it uses nothing else of the rig.
struct Evidence {
  const diagnosis::Measurement* pegged = nullptr;  ///< identification: inputs to output
  std::vector<std::string> inputs{"a_y"};
  std::string output = "f";
  /// B, 1 kHz: the stick's own equation; none: the drive is not diagnosed.
  std::vector<const recording::Recording*> moving = {};
  /// C, or the newest C+, 1 kHz: the motor's too; none: no latency is measured.
  std::vector<const recording::Recording*> cancelled = {};
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
};

/// What is missing, and what the canceller does about it.
struct Verdict {
  diagnosis::Diagnosis body;                  ///< of the pegged trial, load cell's delay taken off
  std::optional<diagnosis::Diagnosis> drive;  ///< of the stick's own equation
  std::optional<Latency> latency;
  bool cell_is_late = false;      ///< the latency is the load cell's, and large enough to count
  std::vector<Finding> findings;  ///< strongest first
  ConvertedModel control;
  std::string not_carried;  ///< why there is no control model, or empty

  /// Kind of the strongest, or "none".
  [[nodiscard]] std::string kind() const {
    return findings.empty() ? std::string("none") : findings.front().kind;
  }
  /// kFound, kUnexplained or kNothing.
  [[nodiscard]] std::string conclusion() const;
};

/// [N] RMS force from which on a verdict can name an effect.  In the body it is that which makes
/// the held-out error a quarter larger than the noise floor, so that an effect's part of it counts;
/// in the drive it is the least that counts.
double detectable_n(const Verdict& verdict, bool in_drive);

/// A record with the output as if its sensor were not late; the last samples of a stretch then
/// count as not measured.  @param seconds  [s] delay of the sensor
diagnosis::Measurement advanced(const diagnosis::Measurement& record, const std::string& output,
                                double seconds);

/// Diagnoses body, drive and latency, and makes the canceller's model from them, README "The
/// verdict".
/// @param options  threads and progress; inputs, model and search are set here
/// @throws ConfigError when a recording cannot be diagnosed
Verdict diagnose_all(const Evidence& evidence, const DeclaredDrive& declared,
                     const diagnosis::DiagnoseOptions& options);

}  // namespace stillhand::close_the_loop
