// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/carried.hpp"
#include "services/core/diagnosis/detection/detection.hpp"
#include "services/core/diagnosis/detection/noise_floor.hpp"
#include "services/core/diagnosis/drawn_names.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/size.hpp"
#include "services/core/diagnosis/no_model.hpp"
#include "services/core/diagnosis/planted_limits.hpp"
#include "services/core/diagnosis/search.hpp"
#include "services/core/diagnosis/unexplained.hpp"

namespace stillhand::diagnosis {

/// Which baseline: the paper's difference model, static in the inputs, or the one that fits.
enum class ModelClass { kAuto, kArx, kLinear };

/// [N] RMS force from which on an effect counts: 0.1 N move the cursor of the mean subject by 0.8
/// mm RMS, a 26th of the error of a hand at rest; METHOD Eq. DG-76.
inline constexpr double kLeastForce_n = 0.1;

/// What to diagnose, and how.  As it is, it is what `stillhand diagnose` does without options.
struct DiagnoseOptions {
  std::vector<std::string> inputs{"a_y"};
  std::string output = "f";
  ModelClass model = ModelClass::kAuto;
  int order = 4;  ///< of the difference model; paper III-A
  SearchOptions search;
  double least_force_n = kLeastForce_n;   ///< [N] a smaller effect does not count, Eq. DG-76
  double heaviest_kg = kHeaviestHand_kg;  ///< [kg] that a force shows at most, Eq. DG-80
  ForEach for_each = in_order;
  /// Called before each longer step with its name; false ends the diagnosis (Interrupted).
  std::function<bool(const std::string&)> progress = [](const std::string&) { return true; };
};

/// Thrown when progress() returns false.
struct Interrupted : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// An error on samples that the fit has not seen, with its interval of 95 % over the blocks.
struct HeldOutError {
  double rmse = 0.0;  ///< [unit of the output]
  double low = 0.0;
  double high = 0.0;
  double vaf_percent = 0.0;  ///< [%] of the output's variance
};

/// RMS of what an effect explains of samples that the fit has not seen, with its interval of 95 %
/// over the blocks, METHOD Eq. DG-76.
struct Explained {
  double rms = 0.0;  ///< [unit of the output]
  double low = 0.0;
  double high = 0.0;
};

/// One effect of the verdict.
struct FoundEffect {
  Effect effect;
  std::string channel;  ///< measured channel that it depends on; empty: none
  HeldOutError before;
  HeldOutError after;
  double p = 1.0;                 ///< [-] of the improvement by chance
  std::string evidence;           ///< one sentence
  std::vector<std::string> ties;  ///< kinds that explain the data equally well
  double carried = 0.0;           ///< [-] share that the carried model has of it, Eq. DG-68
  std::string why_not_carried;    ///< a clause; empty where it is whole
  Explained explained;            ///< its own size
  bool counts = true;             ///< no output in newtons, or at least least_force_n
  std::vector<Size> sizes;        ///< physical numbers with their standard errors
};

/// The verdict and everything that it is based on.
struct Diagnosis {
  DiagnoseOptions options;
  std::string model_class;  ///< "arx" or "linear"
  std::string output_unit;
  double sample_rate_hz = 0.0;
  std::vector<std::string> notes;
  Baseline baseline;
  HeldOutError baseline_error;
  NoiseFloor noise_floor;
  std::vector<FoundEffect> effects;
  HeldOutError final_error;
  std::optional<Unexplained> unexplained;
  std::optional<NoModel> no_model;        ///< the inputs don't explain the output
  std::vector<SampleFault> screening;     ///< of the recording
  std::vector<PlantedLimit> limits;       ///< of a further effect, by kind, Eq. DG-62
  double detection_limit = 0.0;           ///< [unit of the output] their typical one, or 0
  Model model;                            ///< baseline and effects, fitted together to all samples
  CarriedModel carried;                   ///< what predicts other recordings
  HeldOutError carried_error;             ///< of `carried`, judged as final_error
  DetectionResult before;                 ///< of the baseline's residual
  DetectionResult after;                  ///< of the final model's
  SearchResult search;                    ///< the candidates of every step
  std::optional<NameCounts> drawn_names;  ///< of the strongest effect, METHOD Eq. DG-92
  /// Of verdict_stability(), where it was asked for: the kind of the strongest effect, or a verdict
  /// without one.
  std::optional<NameCounts> stability;

  /// "no model", or "effects found" if one of them counts.
  [[nodiscard]] std::string verdict() const;
  [[nodiscard]] bool has_effect_that_counts() const;
};

/// The residual engine, README: fits the baseline, finds the effects that it lacks, adds them, and
/// judges on held-out blocks.  Pure; deterministic.
/// @throws stillhand::ConfigError when the recording cannot be diagnosed: a missing channel, no
///         excitation, too few samples.
Diagnosis diagnose(const Measurement& measurement, const DiagnoseOptions& options);

}  // namespace stillhand::diagnosis
