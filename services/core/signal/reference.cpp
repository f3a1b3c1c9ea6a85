// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/reference.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/signal/rotation_block.hpp"

namespace stillhand::signal {
namespace {

constexpr double kPaperDuration_s = 180.0;
constexpr std::array<std::int64_t, kReferenceLines> kPaperMultiples{
    2, 3, 5, 7, 11, 17, 23, 37, 59, 87, 131, 199, 310, 467, 719};
// Stream of the phases under the trial's seed.
constexpr std::uint64_t kPhaseStream = 0x5265666572656e63;
constexpr Tick kMaxDuration_ticks = 3'600'000;
bool is_prime(std::int64_t n) {
  if (n < 2) return false;
  for (std::int64_t d = 2; d * d <= n; ++d) {
    if (n % d == 0) return false;
  }
  return true;
}

// Nearest prime above `floor`; of two equally near the smaller.
std::int64_t nearest_prime_above(std::int64_t floor, double wanted) {
  const auto centre = static_cast<std::int64_t>(std::lround(wanted));
  for (std::int64_t away = 0;; ++away) {
    if (centre - away > floor && is_prime(centre - away)) return centre - away;
    if (centre + away > floor && is_prime(centre + away)) return centre + away;
  }
}

std::int64_t coprime_multiple(std::int64_t multiple) {
  if (multiple == 87) return 89;
  if (multiple == 310) return 311;
  return multiple;
}

void check(const ReferenceDesign& design, Tick duration_ticks, double scale_m) {
  if (duration_ticks < 1 || duration_ticks > kMaxDuration_ticks) {
    throw ConfigError("reference.duration_ticks", std::to_string(duration_ticks),
                      "1 to " + std::to_string(kMaxDuration_ticks));
  }
  if (!std::isfinite(scale_m)) {
    throw ConfigError("reference.scale_m", std::to_string(scale_m), "a finite value");
  }
  for (const std::int64_t harmonic : design.harmonics) {
    if (harmonic < 1 || 2 * harmonic >= duration_ticks) {
      throw ConfigError("reference.harmonics", std::to_string(harmonic),
                        "0 < h < " + std::to_string((duration_ticks + 1) / 2) + " (Nyquist)");
    }
  }
}

// Adds scale sin(2 pi h n/N + phase) to every n: sin(a + b) with a the angle at the block's start
// and b the angle within it, so that no rounding error builds up along the record.
void add_line(std::vector<double>& table, std::int64_t harmonic, double phase_rad, double scale) {
  const std::size_t count = table.size();
  const auto angle = [&](std::size_t n) {
    const std::size_t cycles = static_cast<std::size_t>(harmonic) * n % count;
    return kTwoPi * (static_cast<double>(cycles) / static_cast<double>(count));
  };
  const std::size_t block = rotation_block(count);
  std::vector<double> sines(block);
  std::vector<double> cosines(block);
  for (std::size_t r = 0; r < block; ++r) {
    sines[r] = std::sin(angle(r));
    cosines[r] = std::cos(angle(r));
  }
  for (std::size_t first = 0; first < count; first += block) {
    const double start_rad = angle(first) + phase_rad;
    const double s = scale * std::sin(start_rad);
    const double c = scale * std::cos(start_rad);
    const std::size_t length = std::min(block, count - first);
    double* out = table.data() + first;
    for (std::size_t r = 0; r < length; ++r) out[r] += s * cosines[r] + c * sines[r];
  }
}

}  // namespace

ReferenceDesign reference_design(double duration_s, ReferenceSet set) {
  if (!(duration_s >= 5.0 && duration_s <= 3600.0)) {
    throw ConfigError("reference.duration_s", std::to_string(duration_s), "5 to 3600 s");
  }
  ReferenceDesign design{};
  std::int64_t below = 0;
  for (std::size_t k = 0; k < kReferenceLines; ++k) {
    const double stretch = duration_s / kPaperDuration_s;
    if (set == ReferenceSet::kCoprime) {
      const auto multiple = static_cast<double>(coprime_multiple(kPaperMultiples[k]));
      below = nearest_prime_above(below, multiple * stretch);
    } else {
      const auto multiple = static_cast<double>(kPaperMultiples[k]);
      below = std::max<std::int64_t>(std::lround(multiple * stretch), below + 1);
    }
    design.harmonics[k] = below;
    design.amplitudes[k] = 0.75 * std::exp(-0.14 * static_cast<double>(k));
  }
  return design;
}

ReferenceSignal::ReferenceSignal(const ReferenceDesign& design, Tick duration_ticks,
                                 std::uint64_t seed, double scale_m) {
  check(design, duration_ticks, scale_m);
  table_m_.assign(static_cast<std::size_t>(duration_ticks), 0.0);
  Gaussian draw(seed, kPhaseStream);
  for (std::size_t k = 0; k < kReferenceLines; ++k) {
    phases_rad_[k] = kTwoPi * draw.uniform();
    add_line(table_m_, design.harmonics[k], phases_rad_[k], scale_m * design.amplitudes[k]);
  }
}

double ReferenceSignal::peak_m() const noexcept {
  double highest_m = 0.0;
  for (const double x_m : table_m_) highest_m = std::max(highest_m, std::abs(x_m));
  return highest_m;
}

}  // namespace stillhand::signal
