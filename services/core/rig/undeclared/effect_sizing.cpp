// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/undeclared/effect_sizing.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "services/core/rig/parts/band_noise.hpp"
#include "services/core/rig/parts/body.hpp"
#include "services/core/rig/parts/body_response.hpp"
#include "services/core/rig/parts/sensors.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::rig {
namespace {

constexpr std::size_t kSettle = 1000;
constexpr std::size_t kTicks = 40000;
// Eq. RG-37 [ticks]: an impulse response of 2 s, a sample every 40 ms; the force every 20 ms.
constexpr std::size_t kResponse = 2000;
constexpr std::size_t kBetweenTaps = 40;
constexpr std::size_t kTaps = kResponse / kBetweenTaps;
constexpr std::size_t kEvery = 20;
// An arbitrary seed; the size of every effect refers to the same motion.
constexpr std::uint64_t kMotionSeed = 1;
constexpr std::uint64_t kMotionStream = 0x66610003;
constexpr double kIdentification_m_s2 = 0.75 * kGravity_m_s2 / 3.8;
constexpr double kTracking_m_s2 = 1.6;

}  // namespace

PeggedTrial::PeggedTrial(const BodyConfig& body, const StickConfig& stick)
    : body_(body), stick_(stick) {
  BandNoise noise(kMotionSeed, kMotionStream, {0.7, 4.0, kIdentification_m_s2});
  motion_m_s2_.reserve(kTicks);
  for (std::size_t n = 0; n < kTicks; ++n) motion_m_s2_.push_back(noise.step());
  plain_n_ = force_n({});
  plain_rms_n_ = signal::rms(plain_n_);
}

std::vector<double> PeggedTrial::force_n(const ChainEffect& effect) const {
  Body chain(body_, stick_, kControlPeriod_s, effect);
  std::vector<double> force;
  force.reserve(kTicks);
  for (std::size_t n = 0; n < kTicks; ++n) {
    const double each_n = chain.step({motion_m_s2_[n], 0.0, 0.0, true}).hand_force_n;
    if (n >= kSettle) force.push_back(each_n);
  }
  return force;
}

double PeggedTrial::share(const std::vector<double>& with_n) const {
  double sum = 0.0;
  for (std::size_t n = 0; n < with_n.size(); ++n) {
    sum += (with_n[n] - plain_n_[n]) * (with_n[n] - plain_n_[n]);
  }
  return std::sqrt(sum / static_cast<double>(with_n.size())) / plain_rms_n_;
}

double PeggedTrial::beyond_linear_n(const std::vector<double>& with_n) const {
  const auto rows = static_cast<Eigen::Index>((with_n.size() - kResponse) / kEvery);
  Eigen::MatrixXd motion(rows, static_cast<Eigen::Index>(kTaps));
  Eigen::VectorXd force(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::size_t now = kResponse + static_cast<std::size_t>(row) * kEvery;
    force[row] = with_n[now];
    for (std::size_t tap = 0; tap < kTaps; ++tap) {
      motion(row, static_cast<Eigen::Index>(tap)) =
          motion_m_s2_[kSettle + now - tap * kBetweenTaps];
    }
  }
  const Eigen::VectorXd response = motion.colPivHouseholderQr().solve(force);
  const double free = static_cast<double>(rows) - static_cast<double>(kTaps);
  return std::sqrt((force - motion * response).squaredNorm() / free);
}

double sized(double low, double high, double wanted, const std::function<double(double)>& share) {
  double at_low = share(low);
  double at_high = share(high);
  const bool rising = at_high > at_low;
  if (rising ? wanted <= at_low : wanted >= at_low) return low;
  if (rising ? wanted >= at_high : wanted <= at_high) return high;
  while (high / low > 1.001) {
    const double middle = std::sqrt(low * high);
    (((share(middle) < wanted) == rising) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

double tracking_force_rms(const BodyConfig& body, const StickConfig& stick) {
  constexpr int kLines = 27;  // 0.05 Hz apart
  double sum = 0.0;
  for (int k = 0; k < kLines; ++k) {
    sum += std::norm(feedthrough_response(body, stick, false, 0.7 + 0.05 * k));
  }
  return kTracking_m_s2 * std::sqrt(sum / kLines);
}

}  // namespace stillhand::rig
