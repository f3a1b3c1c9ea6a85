// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::motion {
namespace {

using Complex = std::complex<double>;

constexpr std::uint64_t kPhaseStream = 0x6d6f74696f6e;  // "motion"
// Harmonic numbers are band edge times duration; the product of 0.7 Hz and 180 s is 126 less an
// ulp.
constexpr double kEdgeRounding = 1e-9;
constexpr double kRoadReference_1_m = 0.1;
constexpr double kRoadClassA_m3 = 16e-6;
constexpr double kRoadLowest_1_m = 0.011;
constexpr double kRoadHighest_1_m = 2.83;

struct Lines {
  double period_s;
  std::int64_t first;
  std::int64_t last;
};

Lines lines_in_band(const MotionProfile& profile) {
  const double period_s = static_cast<double>(profile.duration_ticks) * kControlPeriod_s;
  const Lines lines{
      period_s,
      std::max<std::int64_t>(
          1, static_cast<std::int64_t>(std::ceil(profile.band_low_hz * period_s - kEdgeRounding))),
      static_cast<std::int64_t>(std::floor(profile.band_high_hz * period_s + kEdgeRounding))};
  if (lines.last < lines.first) {
    throw ConfigError("motion.band_high_hz", std::to_string(profile.band_high_hz),
                      "a band that holds a multiple of 1/" + std::to_string(period_s) + " Hz");
  }
  return lines;
}

MotionSpectrum empty_spectrum(const Lines& lines) {
  MotionSpectrum spectrum;
  spectrum.period_s = lines.period_s;
  spectrum.first = lines.first;
  spectrum.accel_m_s2.assign(static_cast<std::size_t>(lines.last - lines.first + 1), Complex{});
  return spectrum;
}

Complex unit(double phase_rad) { return std::polar(1.0, phase_rad); }

void scale_to(MotionSpectrum& spectrum, double rms_m_s2) {
  if (rms_m_s2 > 0.0) spectrum.scale(rms_m_s2 / spectrum.rms_m_s2());
}

// Eq. MO-11.
double roll_off(const MotionProfile& profile, double f_hz) {
  if (profile.band_order == 0) return 1.0;
  const auto power = 2.0 * static_cast<double>(profile.band_order);
  return 1.0 / std::sqrt((1.0 + std::pow(profile.band_low_hz / f_hz, power)) *
                         (1.0 + std::pow(f_hz / profile.band_high_hz, power)));
}

// The band out to where an edge has fallen to -40 dB, inside what a profile may name as its band:
// a message must not make the grid any larger.
MotionProfile with_skirts(MotionProfile profile) {
  if (profile.band_order == 0) return profile;
  const double reach = std::pow(100.0, 1.0 / static_cast<double>(profile.band_order));
  profile.band_low_hz = std::max(profile.band_low_hz / reach, kLowestBand_hz);
  profile.band_high_hz = std::min(profile.band_high_hz * reach, kHighestBand_hz);
  return profile;
}

// Geometric spacing, rounded, each harmonic once.
std::vector<std::int64_t> tones_over(const Lines& lines) {
  std::set<std::int64_t> tones;
  const double ratio = static_cast<double>(lines.last) / static_cast<double>(lines.first);
  for (int i = 0; i < kDefaultTones; ++i) {
    const double exact = static_cast<double>(lines.first) *
                         std::pow(ratio, static_cast<double>(i) / (kDefaultTones - 1));
    tones.insert(std::clamp<std::int64_t>(std::llround(exact), lines.first, lines.last));
  }
  return {tones.begin(), tones.end()};
}

}  // namespace

MotionSpectrum band_noise(const MotionProfile& profile) {
  if (!(profile.rms_m_s2 > 0.0)) {
    throw ConfigError("motion.rms_m_s2", std::to_string(profile.rms_m_s2),
                      "a positive value for band noise");
  }
  MotionSpectrum spectrum = empty_spectrum(lines_in_band(with_skirts(profile)));
  signal::Gaussian random(profile.seed, kPhaseStream);
  double f_hz = static_cast<double>(spectrum.first) / spectrum.period_s;
  for (Complex& c : spectrum.accel_m_s2) {
    c = roll_off(profile, f_hz) * unit(2.0 * std::numbers::pi * random.uniform());
    f_hz += 1.0 / spectrum.period_s;
  }
  scale_to(spectrum, profile.rms_m_s2);
  return spectrum;
}

MotionSpectrum multisine(const MotionProfile& profile) {
  if (profile.components.empty()) {
    if (!(profile.rms_m_s2 > 0.0)) {
      throw ConfigError("motion.rms_m_s2", std::to_string(profile.rms_m_s2),
                        "a positive value, or components with amplitudes");
    }
    const Lines lines = lines_in_band(profile);
    MotionSpectrum spectrum = empty_spectrum(lines);
    signal::Gaussian random(profile.seed, kPhaseStream);
    for (const std::int64_t k : tones_over(lines)) {
      spectrum.accel_m_s2[static_cast<std::size_t>(k - lines.first)] =
          unit(2.0 * std::numbers::pi * random.uniform());
    }
    scale_to(spectrum, profile.rms_m_s2);
    return spectrum;
  }
  // Checks the components; its keys name the one at fault.
  const signal::Multisine checked(profile.duration_ticks, kControlRateHz, profile.components);
  const auto [low, high] =
      std::minmax_element(checked.components().begin(), checked.components().end(),
                          [](const auto& a, const auto& b) { return a.harmonic < b.harmonic; });
  MotionSpectrum spectrum =
      empty_spectrum({static_cast<double>(profile.duration_ticks) * kControlPeriod_s, low->harmonic,
                      high->harmonic});
  for (const signal::Component& c : checked.components()) {
    // A sin(th) = Re(-j A exp(j th))
    spectrum.accel_m_s2[static_cast<std::size_t>(c.harmonic - low->harmonic)] +=
        Complex{0.0, -c.amplitude_m_s2} * unit(c.phase_rad);
  }
  if (spectrum.rms_m_s2() == 0.0) {
    throw ConfigError("motion.components", "no amplitude", "a component that is not zero");
  }
  scale_to(spectrum, profile.rms_m_s2);
  return spectrum;
}

Range road_band_hz(double speed_m_s) noexcept {
  return {kRoadLowest_1_m * speed_m_s, kRoadHighest_1_m * speed_m_s};
}

MotionSpectrum road(const MotionProfile& profile) {
  const char road_class = profile.road_class.empty() ? '?' : profile.road_class.front();
  if (profile.road_class.size() != 1 || road_class < 'A' || road_class > 'H') {
    throw ConfigError("motion.road_class", profile.road_class, "A to H");
  }
  const Range described_hz = road_band_hz(profile.road_speed_m_s);
  if (profile.band_low_hz < described_hz.min || profile.band_high_hz > described_hz.max) {
    throw ConfigError(
        "motion.band_low_hz",
        std::to_string(profile.band_low_hz) + " to " + std::to_string(profile.band_high_hz) + " Hz",
        std::to_string(described_hz.min) + " to " + std::to_string(described_hz.max) +
            " Hz, where ISO 8608 describes the road at this speed");
  }
  const double g0_m3 = kRoadClassA_m3 * std::pow(4.0, road_class - 'A');
  const double per_hz = g0_m3 * kRoadReference_1_m * kRoadReference_1_m * profile.road_speed_m_s;
  MotionSpectrum spectrum = empty_spectrum(lines_in_band(profile));
  signal::Gaussian random(profile.seed, kPhaseStream);
  for (std::size_t i = 0; i < spectrum.accel_m_s2.size(); ++i) {
    const double w_rad_s = spectrum.rad_s(i);
    const double f_hz = w_rad_s / (2.0 * std::numbers::pi);
    const double amplitude_m = std::sqrt(2.0 * per_hz / (f_hz * f_hz) / spectrum.period_s);
    spectrum.accel_m_s2[i] =
        w_rad_s * w_rad_s * amplitude_m * unit(2.0 * std::numbers::pi * random.uniform());
  }
  scale_to(spectrum, profile.rms_m_s2);
  return spectrum;
}

}  // namespace stillhand::motion
