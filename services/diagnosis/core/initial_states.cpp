// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "diagnosis/core/evaluation.hpp"

namespace stillhand::diagnosis {
namespace {

// A free response counts until it has decayed to this, or for this long.
constexpr double kDecayed = 1e-3;
constexpr double kLongestStart_s = 10.0;

}  // namespace

InitialStates::InitialStates(const Body& body, const Signals& signals,
                             const std::vector<double>& weight) {
  const auto order = static_cast<Eigen::Index>(body.order());
  if (order == 0) return;
  for (const Stretch& stretch : signals.stretches()) {
    const auto longest = static_cast<std::size_t>(kLongestStart_s * signals.rate_hz());
    const std::size_t window = std::min(stretch.end - stretch.first, longest);
    if (window <= body.order()) continue;
    std::vector<double> pulse(window, 0.0);
    pulse[0] = 1.0;
    const Stretch alone{0, window, 0.0};
    const auto response = through_poles(pulse, body.denominator, {alone});
    double peak = 0.0;
    std::size_t length = 1;
    for (std::size_t n = 0; n < window; ++n) peak = std::max(peak, std::abs(response[n]));
    for (std::size_t n = 0; n < window; ++n) {
      if (std::abs(response[n]) > kDecayed * peak) length = n + 1;
    }
    length = std::min(window, std::max(length, body.order() + 1));
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
