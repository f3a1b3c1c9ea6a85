// SPDX-License-Identifier: Apache-2.0
#include "identification/core/excitation_check.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "contract/config_error.hpp"
#include "identification/core/arx.hpp"
#include "signal/spectrum.hpp"

namespace stillhand::identification {
namespace {

// 0.05 m/s^2 gives about 0.16 N of feedthrough (paper IV-A), less than a capstan stick's own
// Coulomb friction of 0.1 to 0.3 N: below that a fit would describe friction and sensor noise.
constexpr double kLeastRms_m_s2 = 0.05;
// Ratio of singular values; leaves about 7 of 16 digits in the parameters.
constexpr double kLeastSingularRatio = 1e-9;
constexpr int kMostLags = 2 * kMaxOrder + 1;
constexpr double kBandLowHz = 0.7;
constexpr double kBandHighHz = 4.0;

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
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(lagged);
  const Eigen::MatrixXd r =
      qr.matrixQR().topRows(kMostLags).triangularView<Eigen::Upper>().toDenseMatrix();
  int order = 0;
  for (int n = 1; n <= kMostLags; ++n) {
    const Eigen::VectorXd singular =
        Eigen::JacobiSVD<Eigen::MatrixXd>(r.topLeftCorner(n, n)).singularValues();
    if (!(singular(n - 1) > kLeastSingularRatio * singular(0))) break;
    order = n;
  }
  return order;
}

double band_share(const Record& record) {
  // Segments of 4 s resolve 0.25 Hz, enough for an edge at 0.7 Hz.
  std::size_t segment = std::min(record.size(), static_cast<std::size_t>(4.0 * record.rate_hz));
  segment = std::max<std::size_t>(8, segment - segment % 2);
  const auto spectra = signal::cross_spectra(record.acceleration_m_s2, record.acceleration_m_s2,
                                             record.rate_hz, segment);
  double inside = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; k < spectra.s_xx.size(); ++k) {
    const double f = spectra.frequency_hz[k];
    all += spectra.s_xx[k];
    if (f >= kBandLowHz && f <= kBandHighHz) inside += spectra.s_xx[k];
  }
  return all > 0.0 ? inside / all : 0.0;
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
  // Ten equations a parameter, and the lags themselves.
  const auto least = static_cast<std::size_t>(10 * (2 * order + 1) + kMostLags);
  if (record.size() < least) {
    found.verdict = "record: got " + std::to_string(record.size()) + " samples, want " +
                    std::to_string(least) + " or more for order " + std::to_string(order);
    return found;
  }
  found.acceleration_rms_m_s2 = rms_about_mean(record.acceleration_m_s2);
  found.force_rms_n = rms_about_mean(record.force_n);
  if (found.acceleration_rms_m_s2 > 0.0) {
    found.band_share = band_share(record);
    found.persistent_order = persistent_order(record.acceleration_m_s2);
  }
  found.verdict = shortcoming(found, order);
  found.sufficient = found.verdict.empty();
  if (found.sufficient) found.verdict = "sufficient";
  return found;
}

}  // namespace stillhand::identification
