// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>

#include "services/diagnosis/core/fitting/modes.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/diagnosis/core/model/evaluation.hpp"
#include "services/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

// A free response counts until it has decayed to this, or for this long.
constexpr double kDecayed = 1e-3;
constexpr double kLongestStart_s = 10.0;
constexpr double kLongestShare = 0.25;  // of the record
// A pole that decays within more than this has no fitted free response: it would be a tone's or a
// drift's.
constexpr double kLongestDecay = 0.125;  // of the record

// The poles that decay soon enough.
std::vector<double> quick_poles(const std::vector<double>& denominator, const Signals& signals) {
  const double largest =
      std::exp(-1.0 / (kLongestDecay * signals.duration_s() * signals.rate_hz()));
  std::vector<std::complex<double>> polynomial{1.0};
  for (const std::complex<double>& pole : signal::poles({1.0, denominator, denominator})) {
    if (std::abs(pole) > largest) continue;
    polynomial.emplace_back(0.0);
    for (std::size_t i = polynomial.size(); i-- > 1;) polynomial[i] -= pole * polynomial[i - 1];
  }
  std::vector<double> quick;
  quick.reserve(polynomial.size());
  for (const std::complex<double>& c : polynomial) quick.push_back(c.real());
  return quick;
}

// Without slow poles (Eq. DG-66) each is quick.
std::vector<double> quick_poles(const Body& body, const Signals& signals) {
  return signals.slow_poles() ? quick_poles(body.denominator, signals) : body.denominator;
}

std::vector<double> all_poles(const Model& model, const Signals& signals) {
  std::vector<double> denominator = quick_poles(model.body, signals);
  for (const Effect& effect : model.effects) {
    const std::vector<double> own = effect_kind(effect.kind).own_poles(effect, signals);
    if (!own.empty()) denominator = product(denominator, quick_poles(own, signals));
  }
  return denominator;
}

}  // namespace

InitialStates::InitialStates(const Body& body, const Signals& signals,
                             const std::vector<double>& weight)
    : InitialStates(quick_poles(body, signals), signals, weight) {}

InitialStates::InitialStates(const Model& model, const Signals& signals,
                             const std::vector<double>& weight)
    : InitialStates(all_poles(model, signals), signals, weight) {}

InitialStates::InitialStates(const std::vector<double>& denominator, const Signals& signals,
                             const std::vector<double>& weight) {
  const std::size_t poles = denominator.size() - 1;
  const auto order = static_cast<Eigen::Index>(poles);
  if (poles == 0) return;
  const double longest_s = std::max(kLongestStart_s, kLongestShare * signals.duration_s());
  for (const Stretch& stretch : signals.stretches()) {
    const auto longest = static_cast<std::size_t>(longest_s * signals.rate_hz());
    const std::size_t window = std::min(stretch.end - stretch.first, longest);
    if (window <= poles) continue;
    std::vector<double> pulse(window, 0.0);
    pulse[0] = 1.0;
    const Stretch alone{0, window, 0.0};
    const auto response = through_poles(pulse, denominator, {alone});
    double peak = 0.0;
    std::size_t length = 1;
    for (std::size_t n = 0; n < window; ++n) peak = std::max(peak, std::abs(response[n]));
    for (std::size_t n = 0; n < window; ++n) {
      if (std::abs(response[n]) > kDecayed * peak) length = n + 1;
    }
    length = std::min(window, std::max(length, poles + 1));
    Eigen::MatrixXd basis(static_cast<Eigen::Index>(length), order);
    std::vector<double> column(response.begin(),
                               response.begin() + static_cast<std::ptrdiff_t>(length));
    for (Eigen::Index j = 0; j < order; ++j) {
      if (j > 0) column = differenced(column, {{0, length, 0.0}});
      for (std::size_t n = 0; n < length; ++n) {
        basis(static_cast<Eigen::Index>(n), j) = column[n] * weight[stretch.first + n];
      }
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis);
    starts_.push_back(
        {stretch.first,
         qr.householderQ() * Eigen::MatrixXd::Identity(static_cast<Eigen::Index>(length), order)});
  }
}

void InitialStates::remove_from(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (const Start& start : starts_) {
    auto rows = columns.middleRows(static_cast<Eigen::Index>(start.first), start.basis.rows());
    rows -= start.basis * (start.basis.transpose() * rows).eval();
  }
}

Eigen::VectorXd InitialStates::part_of(const Eigen::VectorXd& column) const {
  Eigen::VectorXd part = column;
  Eigen::Ref<Eigen::MatrixXd> view(part);
  remove_from(view);
  return column - part;
}

}  // namespace stillhand::diagnosis
