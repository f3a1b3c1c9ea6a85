// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::sensing {

/// Calibration of the sensors, and the filters.
struct Config {
  double accel_sensitivity_v_m_s2 = 0.1019716;
  double accel_x_offset_v = 0.01;
  double accel_y_offset_v = 0.01;
  double accel_z_offset_v = 0.01;
  double accel_range_m_s2 = 16.67;
  double load_cell_sensitivity_v_n = 0.1;
  double load_cell_offset_v = 0.005;
  double adc_range_v = 10.0;
  double encoder_counts_per_rev = 4096.0;
  std::int64_t encoder_zero_counts = 0;
  double antialias_cutoff_hz = 200.0;
  double rate_cutoff_hz = 30.0;
  std::int64_t max_bridged_ticks = 50;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("accel_sensitivity_v_m_s2", self.accel_sensitivity_v_m_s2, Range{0.001, 10.0},
          "[V/(m/s^2)] sensitivity; 1000 mV/g, ADXL203 data sheet");
    visit("accel_x_offset_v", self.accel_x_offset_v, Range{-10.0, 10.0}, "[V] voltage at 0 m/s^2");
    visit("accel_y_offset_v", self.accel_y_offset_v, Range{-10.0, 10.0}, "[V] voltage at 0 m/s^2");
    visit("accel_z_offset_v", self.accel_z_offset_v, Range{-10.0, 10.0}, "[V] voltage at 0 m/s^2");
    visit("accel_range_m_s2", self.accel_range_m_s2, Range{5.0, 500.0},
          "[m/s^2] end of the sensor's range; 1.7 g, ADXL203 data sheet");
    visit("load_cell_sensitivity_v_n", self.load_cell_sensitivity_v_n, Range{0.001, 10.0},
          "[V/N] sensitivity; 100 N gives 10 V");
    visit("load_cell_offset_v", self.load_cell_offset_v, Range{-10.0, 10.0}, "[V] voltage at 0 N");
    visit("adc_range_v", self.adc_range_v, Range{1.0, 20.0}, "[V] input range, each side of zero");
    visit("encoder_counts_per_rev", self.encoder_counts_per_rev, Range{64.0, 1e7},
          "[counts/rev] counts in one turn; paper III-C (4096)");
    visit("encoder_zero_counts", self.encoder_zero_counts, Range{-1e7, 1e7},
          "[counts] reading with the stick upright");
    visit("antialias_cutoff_hz", self.antialias_cutoff_hz, Range{5.0, 450.0},
          "[Hz] second-order Butterworth low-pass of acceleration and force; replaces the paper's "
          "analogue filters (III-A)");
    visit("rate_cutoff_hz", self.rate_cutoff_hz, Range{1.0, 450.0},
          "[Hz] second-order Butterworth low-pass of the differenced encoder angle");
    visit("max_bridged_ticks", self.max_bridged_ticks, Range{0.0, 1000.0},
          "[ticks] longest gap that interpolation bridges; a longer gap restarts the filters");
  }
};

/// One sample of the acquisition board, with its tick; signs as in Sensed.
struct DeviceSample {
  Tick tick = 0;
  double accel_x_v = 0.0;           ///< [V] fore-aft
  double accel_y_v = 0.0;           ///< [V] lateral, + right
  double accel_z_v = 0.0;           ///< [V] vertical, + up
  double load_cell_v = 0.0;         ///< [V] force of hand on stick, + right
  std::int64_t encoder_counts = 0;  ///< [counts] + right
  double roll_rad = 0.0;            ///< [rad] inclinometer
};

/// Calibrated, filtered sample.
struct Sensed {
  double accel_x_m_s2, accel_y_m_s2, accel_z_m_s2;  ///< specific force; z is +1 g at rest
  double roll_rad;
  double force_n;  ///< force of hand on stick, + right
  double theta_rad, omega_rad_s;
  Flags flags;  ///< kInputGap, kInputInvalid, kSaturated
};

/// Calibration and anti-alias filtering.  Acceleration and force pass the same filter, so their
/// ratio, the feedthrough, is unchanged.
///
/// Lost ticks set kInputGap.  Linear interpolation of the calibrated values bridges up to
/// `max_bridged_ticks`, so the filters keep the time base.  The filters start in steady state at
/// the sample if the gap is longer, if the source restarted (a larger step back), and at the first
/// sample.  A channel that is NaN, infinite or impossible holds its last good value and sets
/// kInputInvalid.  A repeated or late sample gives the last output again with kInputInvalid.
/// Source: README Eq. SE-1 to SE-4; paper III-A.
/// Pure; never allocates or throws after construction.
class Conditioner {
 public:
  /// @throws stillhand::ConfigError naming the first field that is out of range.
  explicit Conditioner(const Config& config);

  Sensed step(const DeviceSample& sample) noexcept;

 private:
  static constexpr std::size_t kAnalogChannels = 4;
  /// Calibrated, unfiltered: accel x, y, z [m/s^2] and force [N]; stick angle and roll [rad].
  struct Calibrated {
    std::array<double, kAnalogChannels> analog{};
    double theta_rad = 0.0;
    double roll_rad = 0.0;
  };

  [[nodiscard]] Calibrated calibrated(const DeviceSample& sample, Flags& flags) const noexcept;
  [[nodiscard]] double in_units(double volts, double offset_v, double units_per_v, double held,
                                Flags& flags) const noexcept;
  [[nodiscard]] double angle(std::int64_t counts, Flags& flags) const noexcept;
  void settle(const Calibrated& now) noexcept;
  void bridge(const Calibrated& now, Tick lost_ticks) noexcept;
  void advance(const Calibrated& now) noexcept;

  Config config_;
  double accel_m_s2_per_v_;
  double force_n_per_v_;
  double rad_per_count_;
  std::array<signal::Butterworth, kAnalogChannels> antialias_;
  signal::Butterworth rate_filter_;
  std::array<double, kAnalogChannels> baseline_{};  ///< x_0 of Eq. SE-2
  Calibrated last_;
  Sensed out_{};
  Tick last_tick_ = 0;
  bool started_ = false;
};

}  // namespace stillhand::sensing
