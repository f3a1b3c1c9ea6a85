// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/ride.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <unsupported/Eigen/FFT>

#include "services/core/contract/config_error.hpp"

namespace stillhand::motion {
namespace {

using Complex = std::complex<double>;

// Longest continuation at each end: 10 s holds several cycles of any corner above 0.3 Hz.
constexpr double kMirror_s = 10.0;

std::size_t smooth_at_least(std::size_t n) noexcept {
  for (;; ++n) {
    std::size_t rest = n;
    for (const std::size_t factor : {2u, 3u, 5u}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return n;
  }
}

// The samples of the measured duration and, as far as recorded, of the ramp after it.
std::vector<double> used_part(const MotionProfile& profile) {
  const double rate_hz = profile.ride_rate_hz;
  const auto& record = profile.ride_accel_m_s2;
  if (!(rate_hz >= 2.0 * profile.band_high_hz) || !(rate_hz <= 1e5)) {
    throw ConfigError(
        "motion.ride_rate_hz", std::to_string(rate_hz),
        std::to_string(2.0 * profile.band_high_hz) + " (twice band_high_hz) to 100000");
  }
  const double measured_s = static_cast<double>(profile.duration_ticks) * kControlPeriod_s;
  const double recorded_s = static_cast<double>(record.size()) / rate_hz;
  if (recorded_s < measured_s) {
    throw ConfigError("motion.duration_ticks", std::to_string(profile.duration_ticks),
                      "at most the ride's " + std::to_string(recorded_s) + " s");
  }
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (!std::isfinite(record[i])) {
      throw ConfigError("motion.ride_accel_m_s2[" + std::to_string(i) + "]",
                        std::to_string(record[i]), "a finite value");
    }
  }
  const double used_s = measured_s + static_cast<double>(profile.ramp_ticks) * kControlPeriod_s;
  const auto used = static_cast<std::size_t>(std::ceil(used_s * rate_hz));
  return {record.begin(),
          record.begin() + static_cast<std::ptrdiff_t>(std::min(used, record.size()))};
}

// Sample i of the record continued beyond its ends by its mirror image under a half cosine.
std::vector<double> continued(const std::vector<double>& part, double rate_hz) {
  const std::size_t n = part.size();
  const std::size_t mirror =
      std::min(n - 1, static_cast<std::size_t>(std::floor(kMirror_s * rate_hz)));
  std::vector<double> out(smooth_at_least(n + 2 * mirror), 0.0);
  std::copy(part.begin(), part.end(), out.begin());
  for (std::size_t i = 1; i <= mirror; ++i) {
    const double fade = 0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) /
                                             static_cast<double>(mirror + 1));
    out[n - 1 + i] += fade * part[n - 1 - i];
    out[out.size() - i] += fade * part[i];
  }
  return out;
}

}  // namespace

Ride::Ride(const MotionProfile& profile) : high_hz_(profile.band_high_hz) {
  std::vector<double> part = used_part(profile);
  const auto measured = std::min(
      part.size(), static_cast<std::size_t>(std::ceil(static_cast<double>(profile.duration_ticks) *
                                                      kControlPeriod_s * profile.ride_rate_hz)));
  const auto end = part.begin() + static_cast<std::ptrdiff_t>(measured);
  const double mean = std::accumulate(part.begin(), end, 0.0) / static_cast<double>(measured);
  for (double& a : part) a -= mean;
  for (auto a = part.begin(); a != end; ++a) variance_ += *a * *a / static_cast<double>(measured);
  if (!(variance_ > 0.0)) throw ConfigError("motion.ride_accel_m_s2", "no motion", "a ride");

  const std::vector<double> samples = continued(part, profile.ride_rate_hz);
  const std::vector<Complex> in(samples.begin(), samples.end());
  std::vector<Complex> lines;
  Eigen::FFT<double> transform;
  transform.fwd(lines, in);
  recorded_.period_s = static_cast<double>(samples.size()) / profile.ride_rate_hz;
  const auto last = std::min(static_cast<std::size_t>(std::floor(high_hz_ * recorded_.period_s)),
                             (samples.size() - 1) / 2);
  for (std::size_t k = 1; k <= last; ++k) {
    recorded_.accel_m_s2.push_back(lines[k] * (2.0 / static_cast<double>(samples.size())));
  }
  if (recorded_.accel_m_s2.empty()) {
    throw ConfigError("motion.duration_ticks", std::to_string(profile.duration_ticks),
                      "at least a cycle of band_high_hz");
  }
}

// Eq. MO-14.
MotionSpectrum Ride::above(double corner_hz) const {
  MotionSpectrum out = recorded_;
  for (std::size_t i = 0; i < out.accel_m_s2.size(); ++i) {
    const double f_hz = out.rad_s(i) / (2.0 * std::numbers::pi);
    double gain = 1.0 / (1.0 + std::pow(corner_hz / f_hz, 8));
    const double edge = (f_hz / high_hz_ - 0.8) / 0.2;
    if (edge > 0.0) gain *= 0.5 + 0.5 * std::cos(std::numbers::pi * std::min(edge, 1.0));
    out.accel_m_s2[i] *= gain;
  }
  return out;
}

}  // namespace stillhand::motion
