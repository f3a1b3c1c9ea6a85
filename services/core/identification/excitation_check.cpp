// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/excitation_check.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <sstream>

#include "services/core/contract/config_error.hpp"
#include "services/core/identification/arx.hpp"
#include "services/core/identification/lagged_products.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::identification {
namespace {

// 0.05 m/s^2 gives about 0.16 N of feedthrough (paper IV-A), less than a capstan stick's own
// Coulomb friction of 0.1 to 0.3 N: below that a fit would describe friction and sensor noise.
constexpr double kLeastRms_m_s2 = 0.05;
// Ratio of singular values; leaves about 7 of 16 digits in the parameters.
constexpr double kLeastSingularRatio = 1e-9;
// Squares of singular values are known to some 1e-14 of the largest.
constexpr double kPlainRatio = 1e-6;
constexpr int kMostLags = 2 * kMaxOrder + 1;

double rms_about_mean(const std::vector<double>& samples) {
  const Eigen::Map<const Eigen::ArrayXd> x(samples.data(),
                                           static_cast<Eigen::Index>(samples.size()));
  return std::sqrt((x - x.mean()).square().mean());
}

// Rank of the matrix of lagged copies, grown one lag at a time: the smallest singular value of the
// first n columns never grows with n.  The matrix itself is used, not a covariance: end effects
// of a covariance estimate would make a single sinusoid look rich.
int persistent_order(const std::vector<double>& a) {
  const auto rows = static_cast<Eigen::Index>(a.size()) - kMostLags + 1;
  Eigen::MatrixXd lagged(rows, kMostLags);
  for (int lag = 0; lag < kMostLags; ++lag) {
    lagged.col(lag) = Eigen::Map<const Eigen::VectorXd>(a.data() + kMostLags - 1 - lag, rows);
  }
  const Eigen::MatrixXd r = signal::upper_factor(lagged);
  const auto independent = [&](int n) {
    const Eigen::VectorXd singular = signal::singular_values(r.topLeftCorner(n, n));
    return singular(n - 1) > kLeastSingularRatio * singular(0);
  };
  // Not std::views::iota: clang 14 (tests/fuzz) does not compile that of GCC 12.
  std::array<int, kMostLags> lags{};
  std::iota(lags.begin(), lags.end(), 1);
  return static_cast<int>(std::ranges::partition_point(lags, independent) - lags.begin());
}

// Whether persistent_order() is `count` or more, from the products of the same rows: true only
// where their rounding, far below kPlainRatio, can't be what makes it so.
bool plainly_persistent(const std::vector<double>& a, int count) {
  const auto end = static_cast<Eigen::Index>(a.size());
  const Eigen::MatrixXd gram = lagged_gram({&a}, count - 1, kMostLags - 1, end);
  const Eigen::VectorXd squares = signal::symmetric_eigenvalues(gram);
  return squares(0) > kPlainRatio * kPlainRatio * squares(count - 1);
}

// Ten equations a parameter, and the lags themselves.
std::size_t least_samples(int order) {
  return 10 * (2 * static_cast<std::size_t>(order) + 1) + kMostLags;
}

std::string shortcoming(const Excitation& found, int order) {
  std::ostringstream text;
  if (found.acceleration_rms_m_s2 < kLeastRms_m_s2) {
    text << "no excitation: the acceleration's RMS about its mean is "
         << found.acceleration_rms_m_s2 << " m/s^2, want " << kLeastRms_m_s2 << " or more";
  } else if (!(found.force_rms_n > 0.0)) {
    text << "the force is constant: is the load cell connected?";
  } else if (found.persistent_order < 2 * order + 1) {
    text << "the acceleration holds " << found.persistent_order << " independent components, want "
         << 2 * order + 1 << " for order " << order << ": a richer motion or a lower order";
  }
  return text.str();
}

}  // namespace

Excitation check_excitation(const Record& record, int order) {
  Excitation found;
  try {
    check(record);
  } catch (const ConfigError& error) {
    found.verdict = error.what();
    return found;
  }
  const std::size_t least = least_samples(order);
  if (record.size() < least) {
    found.verdict = "recording: got " + std::to_string(record.size()) + " samples, want " +
                    std::to_string(least) + " or more for order " + std::to_string(order);
    return found;
  }
  found.acceleration_rms_m_s2 = rms_about_mean(record.acceleration_m_s2);
  found.force_rms_n = rms_about_mean(record.force_n);
  if (found.acceleration_rms_m_s2 > 0.0) {
    found.persistent_order = persistent_order(record.acceleration_m_s2);
  }
  found.verdict = shortcoming(found, order);
  found.sufficient = found.verdict.empty();
  if (found.sufficient) found.verdict = "sufficient";
  return found;
}

void require_excitation(const Record& record, int order) {
  check(record);
  if (record.size() >= least_samples(order) &&
      rms_about_mean(record.acceleration_m_s2) >= kLeastRms_m_s2 &&
      rms_about_mean(record.force_n) > 0.0 &&
      plainly_persistent(record.acceleration_m_s2, 2 * order + 1)) {
    return;
  }
  const Excitation excitation = check_excitation(record, order);
  if (!excitation.sufficient) {
    throw ConfigError("identification.record", excitation.verdict,
                      "a record that excites the body");
  }
}

}  // namespace stillhand::identification
