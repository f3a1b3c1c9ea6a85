// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/signal/decompositions.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

// A free response counts until it has decayed to this, or for this long.
constexpr double kDecayed = 1e-3;
constexpr double kLongestStart_s = 10.0;
constexpr double kLongestShare = 0.25;  // of the record
// A mode that decays within more than this has no fitted free response: it would be a tone's.
constexpr double kLongestDecay = 0.125;  // of the record

// The poles that decay soon enough, and those that turn less than that.
std::vector<double> quick_poles(const std::vector<double>& denominator, const Signals& signals,
                                double least_turn) {
  const double largest =
      std::exp(-1.0 / (kLongestDecay * signals.duration_s() * signals.rate_hz()));
  std::vector<std::complex<double>> poles = signal::poles({1.0, denominator, denominator});
  std::erase_if(poles, [&](const std::complex<double>& pole) {
    return std::abs(std::arg(pole)) >= least_turn && std::abs(pole) > largest;
  });
  return denominator_with(poles);
}

// Without slow poles (Eq. DG-66) each is quick; of them, those that hold a level count.
std::vector<double> quick_poles(const Body& body, const Signals& signals) {
  if (!signals.slow_poles()) return body.denominator;
  return quick_poles(body.denominator, signals,
                     2.0 * std::numbers::pi * signals.lowest_excited_hz() / signals.rate_hz());
}

std::vector<double> all_poles(const Model& model, const Signals& signals) {
  std::vector<double> denominator = quick_poles(model.body, signals);
  for (const Effect& effect : model.effects) {
    const std::vector<double> own = effect_kind(effect.kind).own_poles(effect, signals.rate_hz());
    if (!own.empty()) denominator = product(denominator, quick_poles(own, signals, 0.0));
  }
  return denominator;
}

// D^j (1/A), j < the number of poles: the same for every stretch, as far as it lasts.
class FreeResponses {
 public:
  FreeResponses(const std::vector<double>& denominator, std::size_t window)
      : poles_(denominator.size() - 1) {
    std::vector<double> pulse(window, 0.0);
    pulse.front() = 1.0;
    const std::vector<Stretch> alone{{0, window, 0.0}};
    responses_.push_back(through_poles(pulse, denominator, alone));
    while (responses_.size() < poles_) responses_.push_back(differenced(responses_.back(), alone));
  }

  // Until they have decayed within a window, [samples x poles].
  [[nodiscard]] Eigen::MatrixXd within(std::size_t window) const {
    const std::vector<double>& response = responses_.front();
    double peak = 0.0;
    std::size_t length = window;
    for (std::size_t n = 0; n < window; ++n) peak = std::max(peak, std::abs(response[n]));
    while (length > 1 && !(std::abs(response[length - 1]) > kDecayed * peak)) --length;
    length = std::min(window, std::max(length, poles_ + 1));
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(length), static_cast<Eigen::Index>(poles_));
    for (std::size_t j = 0; j < poles_; ++j) {
      std::copy_n(responses_[j].begin(), length, columns.col(static_cast<Eigen::Index>(j)).data());
    }
    return columns;
  }

 private:
  std::size_t poles_;
  std::vector<std::vector<double>> responses_;
};

// Turns an orthonormal basis so that its directions are orthogonal over these rows alone too, and
// takes the factors from there where most of a direction's power lies there.
void fit_outside(const std::vector<bool>& rows, const Stretch& stretch, Eigen::MatrixXd& basis,
                 Eigen::MatrixXd& dual) {
  constexpr double kMost = 0.5;
  Eigen::MatrixXd there = basis;
  for (Eigen::Index n = 0; n < there.rows(); ++n) {
    if (!rows[stretch.first + static_cast<std::size_t>(n)]) there.row(n).setZero();
  }
  const auto [power, vectors] = signal::symmetric_eigenvectors(there.transpose() * there);
  basis *= vectors;
  there *= vectors;
  dual = basis;
  for (Eigen::Index j = 0; j < basis.cols(); ++j) {
    if (power[j] >= kMost) dual.col(j) = there.col(j) / power[j];
  }
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
  if (poles == 0) return;
  const double share = signals.slow_poles() ? 1.0 : kLongestShare;
  const double longest_s = std::max(kLongestStart_s, share * signals.duration_s());
  const auto longest = static_cast<std::size_t>(longest_s * signals.rate_hz());
  const auto window_of = [&](const Stretch& stretch) {
    return std::min(stretch.end - stretch.first, longest);
  };
  std::size_t widest = 0;
  for (const Stretch& stretch : signals.stretches()) widest = std::max(widest, window_of(stretch));
  const FreeResponses responses(denominator, widest);
  for (const Stretch& stretch : signals.stretches()) {
    if (window_of(stretch) <= poles) continue;
    Eigen::MatrixXd basis = responses.within(window_of(stretch));
    const Eigen::Index length = basis.rows();
    basis.array().colwise() *=
        Eigen::Map<const Eigen::ArrayXd>(weight.data() + stretch.first, length);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis);
    basis = qr.householderQ() * Eigen::MatrixXd::Identity(length, basis.cols());
    Eigen::MatrixXd dual = basis;
    if (!signals.start_rows().empty()) fit_outside(signals.start_rows(), stretch, basis, dual);
    starts_.push_back({stretch.first, std::move(basis), std::move(dual)});
  }
}

void InitialStates::remove_from(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (const Start& start : starts_) {
    auto rows = columns.middleRows(static_cast<Eigen::Index>(start.first), start.basis.rows());
    rows -= start.basis * (start.dual.transpose() * rows).eval();
  }
}

Eigen::VectorXd InitialStates::part_of(const Eigen::VectorXd& column) const {
  Eigen::VectorXd part = column;
  Eigen::Ref<Eigen::MatrixXd> view(part);
  remove_from(view);
  return column - part;
}

}  // namespace stillhand::diagnosis
