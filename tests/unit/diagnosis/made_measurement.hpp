// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "services/core/diagnosis/fitting/screening.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/signal/butterworth.hpp"
#include "services/core/signal/moments.hpp"
#include "services/core/signal/random.hpp"

/// Measurements whose making is known to the last number: difference equations written out, seeded
/// noise.  Nothing here uses the engine's own simulation.
namespace stillhand::diagnosis::made {

inline constexpr double kRateHz = 100.0;

/// White, standard deviation 1.
inline std::vector<double> white(std::size_t count, std::uint64_t seed) {
  signal::Gaussian next(seed, 0);
  std::vector<double> x(count);
  for (double& value : x) value = next();
  return x;
}

inline double rms_of(const std::vector<double>& x) { return signal::rms(x); }

/// Sum of signals, each with its factor.
inline std::vector<double> mix(const std::vector<std::pair<double, std::vector<double>>>& parts) {
  std::vector<double> y(parts.front().second.size(), 0.0);
  for (const auto& [factor, x] : parts) {
    for (std::size_t n = 0; n < y.size(); ++n) y[n] += factor * x[n];
  }
  return y;
}

inline std::vector<double> sum_of(const std::vector<double>& a, const std::vector<double>& b) {
  return mix({{1.0, a}, {1.0, b}});
}

inline Eigen::VectorXd column_of(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), std::ssize(x));
}

inline std::vector<double> scaled_to(std::vector<double> x, double rms) {
  const double factor = rms / rms_of(x);
  for (double& value : x) value *= factor;
  return x;
}

/// Noise between two frequencies, RMS 1: like a ride.
inline std::vector<double> ride(std::size_t count, std::uint64_t seed, double low_hz = 0.5,
                                double high_hz = 8.0) {
  const signal::Butterworth high_pass(2, low_hz, kRateHz, signal::Passband::kHigh);
  const signal::Butterworth low_pass(4, high_hz, kRateHz);
  return scaled_to(signal::filtered(low_pass, signal::filtered(high_pass, white(count, seed))),
                   1.0);
}

/// Uninterrupted from 0 s.
inline Measurement measurement_of(std::vector<Channel> channels, double rate_hz = kRateHz) {
  Measurement made;
  made.source = "made";
  made.rate_hz = rate_hz;
  made.weight.assign(channels.front().values.size(), 1.0);
  made.stretches = {{0, channels.front().values.size(), 0.0}};
  made.channels = std::move(channels);
  return made;
}

inline Signals signals_of(const std::vector<double>& u, const std::vector<double>& y) {
  return {measurement_of({{"u", "V", u}, {"y", "N", y}}), {"u"}, "y"};
}

/// Cuts it in two stretches, the second one beginning `pause_s` late.
inline Measurement cut_in_two(Measurement measurement, std::size_t at, double pause_s) {
  measurement.stretches = {
      {0, at, 0.0},
      {at, measurement.size(), static_cast<double>(at) / measurement.rate_hz + pause_s}};
  return measurement;
}

/// A(q) y = B(q) u from rest, sample by sample.
inline std::vector<double> answer(const std::vector<double>& b, const std::vector<double>& a,
                                  const std::vector<double>& u) {
  std::vector<double> y(u.size(), 0.0);
  for (std::size_t n = 0; n < u.size(); ++n) {
    for (std::size_t i = 0; i < b.size() && i <= n; ++i) y[n] += b[i] * u[n - i];
    for (std::size_t j = 1; j < a.size() && j <= n; ++j) y[n] -= a[j] * y[n - j];
  }
  return y;
}

inline std::vector<double> answer(const Body& body, const std::vector<double>& u) {
  return answer(body.numerators[0], body.denominator, u);
}

/// Before a stretch, Eq. DG-54: the mean m of the first second and its swing s.
inline double level_of(const std::vector<double>& u) {
  const auto count = std::min<std::size_t>(static_cast<std::size_t>(kRateHz) + 1, u.size());
  double m = 0.0;
  double square = 0.0;
  for (std::size_t n = 0; n < count; ++n) m += u[n] / static_cast<double>(count);
  for (std::size_t n = 0; n < count; ++n) {
    square += std::pow(u[n] - m, 2) / static_cast<double>(count);
  }
  if (m * m <= square) return 0.0;
  return m * m >= 4.0 * square ? m : m * (m * m - square) / (3.0 * square);
}

/// The same after 40 s at that level: in its steady state.
inline std::vector<double> settled_answer(const std::vector<double>& b,
                                          const std::vector<double>& a,
                                          const std::vector<double>& u) {
  constexpr std::size_t kBefore = 4000;
  std::vector<double> longer(kBefore, level_of(u));
  longer.insert(longer.end(), u.begin(), u.end());
  const std::vector<double> y = answer(b, a, longer);
  return {y.begin() + kBefore, y.end()};
}

/// Product of polynomials in q^-1.
inline std::vector<double> times(const std::vector<double>& left,
                                 const std::vector<double>& right) {
  std::vector<double> product(left.size() + right.size() - 1, 0.0);
  for (std::size_t i = 0; i < left.size(); ++i) {
    for (std::size_t j = 0; j < right.size(); ++j) product[i + j] += left[i] * right[j];
  }
  return product;
}

/// 1 + a_1 q^-1 + a_2 q^-2 of one mode.
inline std::vector<double> mode(double frequency_hz, double damping_ratio,
                                double rate_hz = kRateHz) {
  const double w = 2.0 * std::numbers::pi * frequency_hz / rate_hz;
  const double radius = std::exp(-damping_ratio * w);
  return {1.0, -2.0 * radius * std::cos(w * std::sqrt(1.0 - damping_ratio * damping_ratio)),
          radius * radius};
}

/// Like a hand on a held stick: modes at 2.5 and 7 Hz, a notch between them, -3.2 at rest.
inline Body four_pole_body() {
  Body body;
  body.denominator = times(mode(2.5, 0.35), mode(7.0, 0.25));
  std::vector<double> b = times(mode(5.0, 0.15), {1.0, -0.5, 0.06});
  double above = 0.0;
  double below = 0.0;
  for (const double c : b) above += c;
  for (const double c : body.denominator) below += c;
  for (double& c : b) c *= -3.2 * below / above;
  body.numerators = {b};
  return body;
}

/// One mode at 3 Hz, an answer that comes at once.
inline Body two_pole_body() {
  Body body;
  body.denominator = mode(3.0, 0.3);
  body.numerators = {{0.5, -0.6, 0.2}};
  return body;
}

/// y = body(u) + 0.3 v + noise of 0.05; v is no channel that a model of u knows.
inline Measurement with_another_channel(std::size_t count) {
  const auto u = ride(count, 1);
  const auto v = ride(count, 2);
  const auto y = mix({{1.0, answer(two_pole_body(), u)}, {0.3, v}, {0.05, white(count, 3)}});
  return measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", y}});
}

inline std::complex<double> response(const Body& body, double frequency_hz) {
  const std::complex<double> back =
      std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz / kRateHz);
  const auto at = [&](const std::vector<double>& c) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = c.size(); i-- > 0;) sum = sum * back + c[i];
    return sum;
  };
  return at(body.numerators.front()) / at(body.denominator);
}

inline Model model_of(Body body, std::vector<Effect> effects = {}) {
  return {kRateHz, {"u"}, "y", "N", std::move(body), std::move(effects)};
}

/// An effect in a list: what makes it, without a line for each.
inline Effect effect_of(std::string kind, std::string form, std::vector<std::string> channels,
                        std::vector<Parameter> parameters, std::vector<double> coefficients = {}) {
  return {std::move(kind), std::move(form), std::move(channels), std::move(parameters),
          std::move(coefficients)};
}

/// A measurement with everything that a proposal looks at; order of the baseline as given.
struct Studied {
  Studied(const Measurement& measurement, int order)
      : signals(measurement, {"u"}, "y"),
        blocks(make_blocks(signals)),
        baseline(fit_baseline(signals, blocks, order)),
        impulse_response(fit_impulse_response(signals)),
        screening(baseline.model, signals, blocks, impulse_response) {}
  Studied(const Studied&) = delete;
  Studied& operator=(const Studied&) = delete;

  Signals signals;
  Blocks blocks;
  Baseline baseline;
  ImpulseResponse impulse_response;
  Screening screening;
};

}  // namespace stillhand::diagnosis::made
