// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/core/contract/tick.hpp"

namespace stillhand::signal {

/// Sinusoids in the target; paper III-B.
inline constexpr std::size_t kReferenceLines = 15;

/// Which multiples of 1/180 Hz the fifteen frequencies start from.
enum class ReferenceSet {
  kPaper,    ///< as printed, 2 3 5 ... 59 87 131 199 310 467 719; 87 and 310 share factors
  kCoprime,  ///< 89 for 87 and 311 for 310: pairwise coprime, and primes at every duration
};

/// Harmonics of the trial's own length and the amplitudes of paper Eq. 8.
struct ReferenceDesign {
  std::array<std::int64_t, kReferenceLines> harmonics;  ///< h_k [cycles a trial], rising
  std::array<double, kReferenceLines> amplitudes;       ///< 0.75 exp(-0.14 (k-1)) [-], k from 1
};

/// The paper's fifteen frequencies m_k / 180 s on a trial of another length T, README Eq. SG-14:
///
///   h_k = max(round(m_k T / 180 s), h_{k-1} + 1),  h_0 = 0
///
/// so every sinusoid has whole cycles in the trial.  Below 180 s the lowest lines fall together and
/// move up to the next free harmonic; at 180 s the harmonics are m_k itself.  kCoprime takes the
/// nearest prime above h_{k-1} instead.
/// @param duration_s  T [s], 5 to 3600
/// @throws stillhand::ConfigError when it is outside.
ReferenceDesign reference_design(double duration_s, ReferenceSet set = ReferenceSet::kPaper);

/// Target x_r of the tracking task, README Eq. SG-7 (paper Eq. 8), n ticks after the start:
///
///   x_r(n) = scale sum_k A_k sin(2 pi h_k n / N + phi_k),  phi_k uniform in [0, 2 pi) from the
///   seed
///
/// Periodic with N, also before 0 and after N; ramps are the user's.  One period is tabulated at
/// construction; at() reads it.  Error below 1e-15 of the scale a line.  Screen frame: + right.
/// Pure; at() allocates nothing.
class ReferenceSignal {
 public:
  /// @param duration_ticks  N [ticks], more than twice the largest harmonic, at most 3 600 000
  /// @param seed            of the phases; equal seeds give equal targets
  /// @param scale_m         screen displacement of one unit of Eq. 8 [m], finite
  /// @throws stillhand::ConfigError when a bound is broken.
  ReferenceSignal(const ReferenceDesign& design, Tick duration_ticks, std::uint64_t seed,
                  double scale_m);

  /// Target [m] at `since_start` ticks from the first measured tick; any sign.
  [[nodiscard]] double at(Tick since_start) const noexcept {
    const auto period = static_cast<Tick>(table_m_.size());
    Tick n = since_start % period;
    if (n < 0) n += period;
    return table_m_[static_cast<std::size_t>(n)];
  }
  /// Largest |x_r(n)| [m].
  [[nodiscard]] double peak_m() const noexcept;
  [[nodiscard]] const std::array<double, kReferenceLines>& phases_rad() const noexcept {
    return phases_rad_;
  }

 private:
  std::array<double, kReferenceLines> phases_rad_{};
  std::vector<double> table_m_;
};

}  // namespace stillhand::signal
