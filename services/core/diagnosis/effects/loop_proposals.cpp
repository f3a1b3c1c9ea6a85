// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/effects/loop_proposals.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

const std::vector<double> kThresholds{0.5, 1.0, 1.7, 3.0};  // [standard deviations]

std::vector<double> shaped(const std::vector<double>& z, double threshold, const Shape& shape,
                           const std::vector<Stretch>& stretches) {
  std::vector<double> phi(z.size());
  for (const Stretch& stretch : stretches) {
    LoopMemory memory;
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      phi[n] = shape(z[n] / threshold, memory);
    }
  }
  return phi;
}

// Numerator, over the body's denominator, of one mode's displacement: the other poles cancelled.
std::vector<std::vector<double>> mode_numerators(const Body& body) {
  std::vector<std::vector<double>> all;
  const auto poles = signal::poles({1.0, body.denominator, body.denominator});
  for (const std::complex<double>& pole : poles) {
    if (pole.imag() < 1e-9 && pole.imag() > -1e-9 && poles.size() > 1) continue;
    if (pole.imag() < 0.0) continue;
    std::vector<std::complex<double>> numerator{0.0, 1.0};  // a displacement answers a sample later
    for (const std::complex<double>& other : poles) {
      if (other == pole || other == std::conj(pole)) continue;
      numerator.emplace_back(0.0);
      for (std::size_t i = numerator.size(); i-- > 1;) numerator[i] -= other * numerator[i - 1];
    }
    numerator.resize(body.order() + 1);
    std::vector<double> real(numerator.size());
    std::ranges::transform(numerator, real.begin(), [](const auto& c) { return c.real(); });
    all.push_back(real);
  }
  return all;
}

Proposal output_loop(const Screening& screening, const Effect& effect, const Shape& shape,
                     double threshold) {
  const std::vector<double>& y = screening.body_output();
  const auto& stretches = screening.signals().stretches();
  std::vector<double> phi = shaped(y, threshold, shape, stretches);
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.end; n-- > stretch.first + 1;) phi[n] = phi[n - 1];
    phi[stretch.first] = 0.0;
  }
  Columns columns = screening.through_body(phi);
  columns.pop_back();
  const ScreenedGain gain = screening.gain(columns);
  Proposal proposal{effect, gain.share, {}};
  proposal.effect.form += " of the output";
  proposal.effect.coefficients = gain.coefficients;
  Parameter& scale = proposal.effect.parameters.front();
  scale = scale.fitted
              ? Parameter{scale.name, scale.unit, threshold, 0.02 * threshold, 50.0 * threshold}
              : constant(scale.name, scale.unit, threshold);
  return proposal;
}

Proposal inside_loop(const Screening& screening, const Effect& effect, const Shape& shape,
                     std::vector<double> numerator, double threshold,
                     const std::vector<double>& z) {
  const std::size_t order = screening.model().body.order();
  const std::vector<double> phi = shaped(z, threshold, shape, screening.signals().stretches());
  const ScreenedGain gain = screening.gain(screening.through_body(phi));
  Proposal proposal{effect, gain.share, {}};
  proposal.effect.form += " inside the body";
  proposal.effect.coefficients = gain.coefficients;
  for (double& each : numerator) each /= threshold;
  const std::vector<double> n = difference_basis(numerator);
  auto& all = proposal.effect.coefficients;
  all.insert(all.end(), n.begin(), n.end());
  all.insert(all.end(), order, 0.0);
  // The threshold is in N's scale.
  proposal.effect.parameters.clear();
  return proposal;
}

}  // namespace

std::vector<Proposal> loop_proposals(const Screening& screening, const std::string& kind,
                                     const std::string& form, const Shape& shape,
                                     bool homogeneous) {
  const Body& body = screening.model().body;
  // One nonlinearity inside the body at a time: the data hardly distinguish two.
  if (body.order() < 2 || feedback_of(screening.model()) != nullptr) return {};
  const std::string& unit = screening.signals().output().unit;
  const Effect effect{kind, form, {}, {{"threshold", unit, 1.0, 0.0, 1.0, !homogeneous}}, {}};
  const std::vector<double> thresholds = homogeneous ? std::vector<double>{1.0} : kThresholds;
  std::vector<Proposal> at_output;
  at_output.reserve(thresholds.size());
  const double deviation = deviation_of(screening.body_output());
  if (!(deviation > 0.0)) return {};
  std::vector<Proposal> inside;
  std::vector<std::vector<double>> places = mode_numerators(body);
  std::vector<double> own = body.numerators.front();
  places.push_back(own);
  for (const double threshold : thresholds) {
    at_output.push_back(output_loop(screening, effect, shape, threshold * deviation));
  }
  for (const auto& numerator : places) {
    const auto z = response_of(screening, numerator, screening.signals().inputs().front().values);
    const double size = deviation_of(z);
    if (!(size > 0.0) || !std::isfinite(size)) continue;
    for (const double threshold : thresholds) {
      inside.push_back(inside_loop(screening, effect, shape, numerator, threshold * size, z));
    }
  }
  std::vector<Proposal> all = best_of(std::move(at_output), 1);
  append(all, best_of(std::move(inside), 1));
  return all;
}

double threshold_of(const Effect& effect) {
  return effect.parameters.empty() ? 1.0 : effect.value(0);
}

}  // namespace stillhand::diagnosis
