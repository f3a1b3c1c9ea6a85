// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace stillhand::clock {

/// The four stamps of a two-way exchange: asked and answered by one clock each.
struct Exchange {
  std::int64_t asked_ns = 0;     ///< t1, own clock
  std::int64_t received_ns = 0;  ///< t2, the other's clock
  std::int64_t answered_ns = 0;  ///< t3, the other's clock
  std::int64_t back_ns = 0;      ///< t4, own clock
};

/// What is known of another clock.
struct ClockOffset {
  std::int64_t offset_ns = 0;      ///< other minus own, now
  double uncertainty_ns = 0.0;     ///< half width, Eq. CK-4
  double drift_ppm = 0.0;          ///< [1e-6] by how much faster the other runs
  double drift_sigma_ppm = 0.0;    ///< [1e-6] of it; infinite while the window is short
  std::int64_t round_trip_ns = 0;  ///< shortest in the window
  std::int64_t steps = 0;          ///< times the other clock jumped since the start

  /// A clock whose drift is more than what a disciplined one may have, and more than chance.
  [[nodiscard]] bool drifts() const noexcept;
};

/// Offset and drift of another host's clock from two-way exchanges, README Eq. CK-1 to CK-5.
/// Robust: an exchange that was held up on its way counts less or not at all.  Pure; one thread;
/// never allocates.
class ClockComparison {
 public:
  static constexpr std::size_t kWindow = 64;  ///< exchanges remembered

  /// Takes an exchange; later ones have a later t4.  What isn't one (t4 before t1, t3 before t2, a
  /// round trip above a second) is passed over.
  /// @return by how much the other clock has jumped [ns], when this exchange shows it
  std::optional<std::int64_t> take(const Exchange& exchange) noexcept;

  /// @param now_ns  own clock
  /// @return nothing before eight exchanges
  [[nodiscard]] std::optional<ClockOffset> offset(std::int64_t now_ns) const noexcept;

 private:
  struct Sample {
    double at_s = 0.0;      ///< own clock, from origin_ns_
    double offset_s = 0.0;  ///< from origin_offset_ns_
    double round_trip_s = 0.0;
  };
  struct Line {
    double at_s = 0.0;
    double offset_s = 0.0;
    double drift = 0.0;          ///< [s/s]
    double drift_sigma = 0.0;    ///< [s/s]
    double spread_s = 0.0;       ///< scaled median absolute deviation
    double round_trip_s = 0.0;   ///< of the quickest exchange
    double quickest_at_s = 0.0;  ///< when that was
    double beside_s = 0.0;       ///< how far the line passes by its offset
    std::size_t used = 0;
  };

  [[nodiscard]] Line fitted() const noexcept;
  void forget_but(std::size_t newest) noexcept;

  std::array<Sample, kWindow> samples_{};
  std::size_t count_ = 0;  ///< samples in the window, oldest first
  std::int64_t origin_ns_ = 0;
  std::int64_t origin_offset_ns_ = 0;
  std::size_t away_ = 0;  ///< newest samples in a row beside the line, to one side
  bool away_above_ = false;
  std::int64_t steps_ = 0;
};

}  // namespace stillhand::clock
