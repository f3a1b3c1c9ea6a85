// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/effect_sizes.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/signal/butterworth.hpp"
#include "services/core/signal/moments.hpp"
#include "services/core/signal/random.hpp"

/// Recordings whose truth is known.
namespace stillhand::diagnose::test {

inline constexpr double kRate_hz = 100.0;

/// White noise of unit deviation below a frequency.
inline std::vector<double> smooth_noise(double duration_s, double cutoff_hz, std::uint64_t stream) {
  signal::Gaussian gaussian(1, stream);
  std::vector<double> x(static_cast<std::size_t>(duration_s * kRate_hz));
  for (double& value : x) value = gaussian();
  x = signal::filtered(signal::Butterworth(4, cutoff_hz, kRate_hz), x);
  const double rms = signal::rms(x);
  for (double& value : x) value /= rms;
  return x;
}

/// a_y and omega, independent of each other, and f, still zero.
inline diagnosis::Measurement moving_hand(double duration_s) {
  diagnosis::Measurement measurement;
  measurement.source = "ride.csv";
  measurement.rate_hz = kRate_hz;
  measurement.channels = {{"a_y", "m/s^2", smooth_noise(duration_s, 4.0, 1)},
                          {"omega", "rad/s", smooth_noise(duration_s, 1.0, 2)}};
  const std::size_t count = measurement.channels[0].values.size();
  measurement.channels.push_back({"f", "N", std::vector<double>(count, 0.0)});
  measurement.weight.assign(count, 1.0);
  measurement.stretches = {{0, count, 0.0}};
  return measurement;
}

/// What a diagnosis would be that found exactly one effect, and a recording that the model with it
/// made itself, with white noise.
struct MadeDiagnosis {
  diagnosis::Diagnosis found;
  diagnosis::Measurement measurement;
};

inline MadeDiagnosis made_with(const diagnosis::Body& body, const diagnosis::Effect& effect,
                               double noise_n) {
  MadeDiagnosis made{{}, moving_hand(60.0)};
  // The output must move for Signals to take it.
  made.measurement.channels[2].values = made.measurement.channels[0].values;
  diagnosis::Diagnosis& found = made.found;
  found.output_unit = "N";
  found.sample_rate_hz = kRate_hz;
  found.baseline.model.rate_hz = kRate_hz;
  found.baseline.model.inputs = {"a_y"};
  found.baseline.model.output = "f";
  found.baseline.model.body = body;
  found.model = found.baseline.model;
  found.model.output_unit = "N";
  found.model.effects = {effect};
  diagnosis::FoundEffect one;
  one.effect = effect;
  found.effects = {one};
  const diagnosis::Signals signals(made.measurement, {"a_y"}, "f");
  std::vector<double>& force_n = made.measurement.channels[2].values;
  force_n = diagnosis::free_run(found.model, signals).prediction;
  signal::Gaussian noise(1, 9);
  for (double& value : force_n) value += noise_n * noise();
  const diagnosis::Signals heard(made.measurement, {"a_y"}, "f");
  const diagnosis::Linearisation line = diagnosis::linearised(found.model, heard);
  found.effects.front().sizes =
      diagnosis::effect_sizes(diagnosis::size_case(found.model, 0, heard, line.run),
                              diagnosis::NumberErrors(found.model, line, heard));
  return made;
}

}  // namespace stillhand::diagnose::test
