// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/record/excited_band.hpp"
#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/identification/frequency_response.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::identify {

struct IdentifyOptions {
  std::string input = "a_y";
  std::string output = "f";
  identification::Config config;
  double heaviest_kg = diagnosis::kHeaviestHand_kg;  ///< [kg] that a force shows at most, Eq. DG-80
};

/// Lowest minimum in frequency, 0.5 to 10 Hz, from which the gain rises by 1 dB to either side.
struct Notch {
  double frequency_hz;
  double magnitude_db;
};

/// The paper's fit of one recording, and its evaluation.  Coefficients and magnitudes are in the
/// output's unit per the input's unit.
struct IdentifyResult {
  std::string source;
  std::string input, input_unit;
  std::string output, output_unit;
  double rate_hz = 0.0;     ///< [Hz] of the recording
  std::size_t samples = 0;  ///< [-] samples of the recording that were used
  std::vector<std::string> notes;
  std::vector<diagnosis::SampleFault> screening;
  /// `control` is empty if `unusable` is not.
  identification::FeedthroughModel model;
  std::string why_refined;         ///< reason for the refinement; empty: the paper's least squares
  std::string unusable;            ///< why the canceller can't use it; empty: it can
  std::string reason;              ///< of that, in a word: one of NoModel's, "effects" or "filter"
  diagnosis::ExcitedBand excited;  ///< of the input, DG-65
  double dc_gain_db = 0.0;
  std::optional<Notch> notch;
  std::vector<identification::ResponsePoint> response;  ///< of the model, at its own rate
  signal::TransferEstimate measured;                    ///< of the record that was fitted
};

/// Runs the chain of paper III-A (Eqs 3 to 5; identification, Eqs ID-1 to ID-10) on the longest
/// stretch of a recording.  An input in a unit other than m/s^2 is scaled to an RMS of 1 for the
/// fit, because the excitation check expects accelerations; the model is returned in the input's
/// own unit.  Pure.
/// @throws stillhand::ConfigError naming the recording, when a channel is missing or nothing can be
///         identified from it.
IdentifyResult identify(const diagnosis::Measurement& measurement, const IdentifyOptions& options);

}  // namespace stillhand::identify
