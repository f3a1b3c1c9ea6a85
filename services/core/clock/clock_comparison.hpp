// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace stillhand::clock {

/// The four stamps of a two-way exchange, two by each clock.  Source: README Eq. CK-1.
struct Exchange {
  std::int64_t asked_ns = 0;     ///< t1, local clock
  std::int64_t received_ns = 0;  ///< t2, other clock
  std::int64_t answered_ns = 0;  ///< t3, other clock
  std::int64_t back_ns = 0;      ///< t4, local clock
};

/// Estimate of another clock.
struct ClockOffset {
  std::int64_t offset_ns = 0;      ///< other clock minus local clock, now
  double uncertainty_ns = 0.0;     ///< half width, Eq. CK-4
  double drift_ppm = 0.0;          ///< [1e-6] positive: the other clock runs faster
  double drift_sigma_ppm = 0.0;    ///< [1e-6] of drift_ppm; infinite while the window is short
  std::int64_t round_trip_ns = 0;  ///< shortest in the window
  std::int64_t steps = 0;          ///< number of jumps of the other clock since the start

  /// True if the drift is larger than that of a disciplined clock and larger than three sigma,
  /// Eq. CK-5.
  [[nodiscard]] bool drifts() const noexcept;
};

/// Offset and drift of another host's clock from two-way exchanges.  The estimate is robust: a
/// delayed exchange has a smaller weight or none.
/// Source: README Eq. CK-1 to CK-5; RFC 5905; Theil (1950), Sen (1968).
/// Pure; one thread; never allocates.
class ClockComparison {
 public:
  static constexpr std::size_t kWindow = 64;  ///< exchanges remembered

  /// Adds an exchange; t4 must increase.  Ignores an impossible exchange (t4 before t1, t3 before
  /// t2, a round trip above a second).
  /// @return the jump of the other clock [ns], if this exchange completes its detection
  std::optional<std::int64_t> take(const Exchange& exchange) noexcept;

  /// @param now_ns  local clock
  /// @return nothing before eight exchanges
  [[nodiscard]] std::optional<ClockOffset> offset(std::int64_t now_ns) const noexcept;

 private:
  struct Sample {
    double at_s = 0.0;      ///< local clock, from origin_ns_
    double offset_s = 0.0;  ///< from origin_offset_ns_
    double round_trip_s = 0.0;
  };
  struct Line {
    double at_s = 0.0;
    double offset_s = 0.0;
    double drift = 0.0;          ///< [s/s]
    double drift_sigma = 0.0;    ///< [s/s]
    double spread_s = 0.0;       ///< scaled median absolute deviation
    double round_trip_s = 0.0;   ///< shortest round trip
    double quickest_at_s = 0.0;  ///< time of that exchange
    double distance_s = 0.0;     ///< distance between the line and its offset
    std::size_t used = 0;
  };

  [[nodiscard]] Line fitted() const noexcept;
  void forget_but(std::size_t newest) noexcept;

  std::array<Sample, kWindow> samples_{};
  std::size_t count_ = 0;  ///< samples in the window, oldest first
  std::int64_t origin_ns_ = 0;
  std::int64_t origin_offset_ns_ = 0;
  std::size_t away_ = 0;  ///< newest consecutive samples off the line on one side
  bool away_above_ = false;
  std::int64_t steps_ = 0;
};

}  // namespace stillhand::clock
