// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/partial_coherence.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace stillhand::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kLongestSegment = 1024;
constexpr std::size_t kShortestSegment = 32;
constexpr std::size_t kFewestSegments = 20;  // at least, half as many again by the overlap
constexpr std::size_t kFirstLine = 2;        // a Hann window spreads the mean over lines 0 and 1
constexpr double kCollinear = 1e-9;          // of a channel's power left without the inputs: none
constexpr double kLeastWeight = 0.9;         // of a segment's samples

// Where the segments begin.
struct Segments {
  std::size_t length = 0;
  std::vector<std::size_t> first;
};

Segments segments_of(const Signals& signals, const std::vector<double>& weight) {
  Segments segments{kLongestSegment, {}};
  while (segments.length > kShortestSegment && segments.length * kFewestSegments > signals.size()) {
    segments.length /= 2;
  }
  for (const Stretch& stretch : signals.stretches()) {
    for (std::size_t n = stretch.first; n + segments.length <= stretch.end;
         n += segments.length / 2) {
      double counted = 0.0;
      for (std::size_t i = n; i < n + segments.length; ++i) counted += weight[i];
      if (counted >= kLeastWeight * static_cast<double>(segments.length)) {
        segments.first.push_back(n);
      }
    }
  }
  return segments;
}

// Lines of one signal, [segments x lines], mean removed and windowed.
Eigen::MatrixXcd windowed_lines(const double* x, const Segments& segments) {
  const std::size_t length = segments.length;
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> window(length);
  for (std::size_t i = 0; i < length; ++i) {
    const double turn = static_cast<double>(i) / static_cast<double>(length);
    window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
  }
  std::vector<double> part(length);
  std::vector<Complex> lines;
  Eigen::MatrixXcd all(static_cast<Eigen::Index>(segments.first.size()),
                       static_cast<Eigen::Index>(length / 2 + 1));
  for (std::size_t s = 0; s < segments.first.size(); ++s) {
    const double* from = x + segments.first[s];
    double mean = 0.0;
    for (std::size_t i = 0; i < length; ++i) mean += from[i];
    mean /= static_cast<double>(length);
    for (std::size_t i = 0; i < length; ++i) part[i] = (from[i] - mean) * window[i];
    transform.fwd(lines, part);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      all(static_cast<Eigen::Index>(s), static_cast<Eigen::Index>(k)) = lines[k];
    }
  }
  return all;
}

std::vector<const Signal*> other_channels(const Signals& signals) {
  std::vector<const Signal*> others;
  for (const Signal& signal : signals.all()) {
    if (!signal.derived && !signals.is_input(signal.name)) others.push_back(&signal);
  }
  return others;
}

// A signal's segments at one line.
using Column = Eigen::VectorXcd;

// A column without its projection on the basis: conditioned, Eq. DG-45.
Column conditioned(Column column, const std::vector<Column>& basis) {
  const double power = column.squaredNorm();
  for (const Column& each : basis)
    column -= each.dot(column) * each;  // dot() conjugates its left side
  if (column.squaredNorm() <= kCollinear * power) column.setZero();
  return column;
}

// Orthonormal columns that span the inputs at one line; those that depend on others are left
// out.
std::vector<Column> basis_of(const std::vector<Eigen::MatrixXcd>& inputs, Eigen::Index line) {
  std::vector<Column> basis;
  for (const Eigen::MatrixXcd& input : inputs) {
    const Column own = conditioned(input.col(line), basis);
    if (const double norm = own.norm(); norm > 0.0) basis.push_back(own / norm);
  }
  return basis;
}

double coherence_between(const Column& x, const Column& y) {
  const double powers = x.squaredNorm() * y.squaredNorm();
  if (!(powers > 0.0)) return 0.0;
  return std::min(1.0, std::norm(x.dot(y)) / powers);
}

// Threshold and p for `tests` coherences of `averages` independent averages less the conditions,
// Eq. DG-46.
struct Chance {
  double tests = 1.0;
  double exponent = 1.0;

  [[nodiscard]] double threshold() const {
    return 1.0 - std::pow(CoherenceResult::kSignificance / tests, 1.0 / exponent);
  }
  void judge(ChannelCoherence& channel, const std::vector<double>& frequency_hz) const {
    const auto highest = std::ranges::max_element(channel.coherence);
    channel.highest = *highest;
    channel.highest_hz =
        frequency_hz[static_cast<std::size_t>(highest - channel.coherence.begin())];
    channel.p = std::min(1.0, tests * std::pow(1.0 - channel.highest, exponent));
    channel.significant = channel.p < CoherenceResult::kSignificance;
  }
};

void judge_all(std::vector<ChannelCoherence>& channels, double conditions, CoherenceResult& result,
               double& threshold) {
  if (channels.empty()) return;
  const Chance chance{static_cast<double>(channels.size() * result.frequency_hz.size()),
                      result.independent_averages - conditions - 1.0};
  threshold = chance.threshold();
  for (ChannelCoherence& channel : channels) chance.judge(channel, result.frequency_hz);
}

}  // namespace

CoherenceResult coherence_of(const Eigen::VectorXd& residual, const std::vector<double>& weight,
                             const Signals& signals) {
  CoherenceResult result;
  const Segments segments = segments_of(signals, weight);
  const auto count = static_cast<double>(segments.first.size());
  const auto conditions = static_cast<double>(signals.inputs().size());
  const double averages = count / (1.0 + (1.0 - 1.0 / std::max(count, 1.0)) / 18.0);  // SG-10
  if (averages < 2.0 * conditions + 4.0) return result;
  result.independent_averages = averages;
  std::vector<Eigen::MatrixXcd> inputs;
  std::vector<Eigen::MatrixXcd> others;
  for (const Signal& input : signals.inputs()) {
    inputs.push_back(windowed_lines(input.values.data(), segments));
    result.ordinary.push_back({input.name, {}, 0.0, 0.0, 1.0, false});
  }
  for (const Signal* other : other_channels(signals)) {
    others.push_back(windowed_lines(other->values.data(), segments));
    result.partial.push_back({other->name, {}, 0.0, 0.0, 1.0, false});
  }
  const Eigen::MatrixXcd lines = windowed_lines(residual.data(), segments);
  const double length = static_cast<double>(segments.length);
  const double scale = 2.0 / (signals.rate_hz() * 0.375 * length * count);
  double incoherent = 0.0;
  for (Eigen::Index k = kFirstLine; k + 1 < lines.cols(); ++k) {
    const Column r = lines.col(k);
    const std::vector<Column> basis = basis_of(inputs, k);
    const Column left = conditioned(r, basis);
    result.frequency_hz.push_back(static_cast<double>(k) * signals.rate_hz() / length);
    result.residual_density.push_back(scale * r.squaredNorm());
    // The lines that are left out count as the first that isn't.
    const double times = k == kFirstLine ? 1.0 + static_cast<double>(kFirstLine) : 1.0;
    incoherent += times * scale * left.squaredNorm() * averages /
                  (averages - static_cast<double>(basis.size()));
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      result.ordinary[i].coherence.push_back(coherence_between(inputs[i].col(k), r));
    }
    for (std::size_t c = 0; c < others.size(); ++c) {
      result.partial[c].coherence.push_back(
          coherence_between(conditioned(others[c].col(k), basis), left));
    }
  }
  result.incoherent_rms = std::sqrt(incoherent * signals.rate_hz() / length);
  judge_all(result.partial, conditions, result, result.partial_threshold);
  judge_all(result.ordinary, 0.0, result, result.ordinary_threshold);
  return result;
}

}  // namespace stillhand::diagnosis
