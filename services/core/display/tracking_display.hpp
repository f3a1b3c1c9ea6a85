// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/display/screen_layout.hpp"
#include "services/core/signal/reference.hpp"

namespace stillhand::display {

struct TrackingInput {
  Tick tick;
  double theta_rad;  ///< stick angle, + right
  /// What a mitigation takes off it; exactly 0: nothing.  CommandInUse chooses it.
  double taken_off_rad = 0.0;
};

struct TrackingSample {
  double target_m;  ///< x_r on the screen, right of its centre
  double cursor_m;  ///< x_p, same frame
  bool inside;      ///< the cross's centre is inside the box
  Flags flags;      ///< kInputGap, kInputInvalid
};

/// The tracking task: target and cursor on the screen, one pair a tick.
///
///   x_p = g (theta - taken off)                                Eq. DI-1
///   x_r = ramp(t) x_ref(t) inside the armed trial, else 0      Eq. DI-2
///   inside = |x_p - x_r| < w/2                                 Eq. DI-3
///
/// ramp rises over the ticks before the measured part and falls over those after it as
/// 10 u^3 - 15 u^4 + 6 u^5: velocity and acceleration stay continuous.  Frame: screen, + right.
/// Source: paper sections III-B and III-C, Eq. 8 (x_ref: signal/reference.hpp).
/// A theta that isn't finite holds the cursor and counts as outside.  Pure; step() never allocates,
/// locks or throws; arm() may allocate and throw.
class TrackingDisplay {
 public:
  struct Config {
    double gain_m_rad = 0.6;
    double box_width_m = 0.030;
    double reference_scale_m = 0.049;
    bool coprime_reference = false;
    ScreenConfig screen;

    template <typename Visitor, typename Self>
    static void fields(Visitor&& visit, Self& self) {
      visit("gain_m_rad", self.gain_m_rad, Range{0.01, 10.0},
            "[m/rad] screen displacement of the cursor a radian of stick; paper III-C (0.6)");
      visit("box_width_m", self.box_width_m, Range{0.002, 0.2},
            "[m] width of the target box; paper III-C (30 mm)");
      visit("reference_scale_m", self.reference_scale_m, Range{0.0, 0.5},
            "[m] screen displacement of one unit of the paper's Eq. 8, which gives none; README, "
            "\"The target's scale\"");
      visit("coprime_reference", self.coprime_reference, Range{0.0, 1.0},
            "[-] truly coprime multiples 89 and 311 instead of the paper's 87 and 310");
      visit.group("screen", self.screen);
    }
  };

  /// @throws stillhand::ConfigError naming the first field that is out of range.
  explicit TrackingDisplay(const Config& config);

  /// Takes over a trial's target in exchange for the one before, so that nothing is freed here.
  /// @param reference  made for trial.duration_ticks, e.g. by `reference_on_screen`
  /// @throws stillhand::ConfigError when the trial's ticks are out of range.
  void arm(signal::ReferenceSignal&& reference, const Trial& trial);
  /// The same with the target that `reference_on_screen` makes; the target of a trial that isn't
  /// tracking stands in the centre.
  void arm(const Trial& trial, std::uint64_t reference_seed);
  /// Drops the trial: the target stands in the centre.
  void disarm() noexcept { trial_ = Trial{}; }
  /// The trial that is armed begins at another tick.
  void postpone(const Trial& trial) noexcept {
    if (trial.number == trial_.number) trial_.start_tick = trial.start_tick;
  }

  TrackingSample step(const TrackingInput& input) noexcept;

  [[nodiscard]] const Trial& trial() const noexcept { return trial_; }

 private:
  [[nodiscard]] double target_at(Tick tick) const noexcept;

  Config config_;
  std::optional<signal::ReferenceSignal> reference_;
  Trial trial_;
  double cursor_m_ = 0.0;
  Tick last_tick_ = -1;
};

/// The target of a trial, whose box never leaves the screen: phases are drawn from `seed` and, as
/// long as the box would leave it, again from a seed derived from it (Eq. DI-6).
/// @param duration_ticks  measured part of the trial, 5 s to 3600 s
/// @throws stillhand::ConfigError when the duration is out of range or no draw fits the screen.
signal::ReferenceSignal reference_on_screen(const TrackingDisplay::Config& config,
                                            Tick duration_ticks, std::uint64_t seed);

}  // namespace stillhand::display
