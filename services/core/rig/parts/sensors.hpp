// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/rig/parts/sensor_noise.hpp"

namespace stillhand::rig {

/// Standard gravity [m/s^2], ISO 80000-3.

/// Sensors and the acquisition board.
struct SensorConfig {
  double accel_sensitivity_v_m_s2 = 0.1019716;
  double accel_offset_v = 0.01;
  double accel_noise_m_s2_rthz = 1.08e-3;
  double accel_range_m_s2 = 16.67;
  double load_cell_sensitivity_v_n = 0.1;
  double load_cell_offset_v = 0.005;
  double load_cell_noise_n_rthz = 1.0e-3;
  std::int64_t encoder_counts_per_rev = 4096;
  double inclinometer_step_rad = 1.745e-4;
  double adc_range_v = 10.0;
  std::int64_t adc_bits = 16;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("accel_sensitivity_v_m_s2", self.accel_sensitivity_v_m_s2, Range{0.001, 10.0},
          "[V/(m/s^2)] sensitivity; 1000 mV/g, ADXL203 data sheet");
    visit("accel_offset_v", self.accel_offset_v, Range{-1.0, 1.0},
          "[V] offset that remains after subtraction of the zero-g level");
    visit("accel_noise_m_s2_rthz", self.accel_noise_m_s2_rthz, Range{0.0, 0.1},
          "[(m/s^2)/sqrt(Hz)] white noise density; 110 ug/sqrt(Hz), ADXL203 data sheet");
    visit("accel_range_m_s2", self.accel_range_m_s2, Range{5.0, 500.0},
          "[m/s^2] end of the sensor's range; 1.7 g, ADXL203 data sheet");
    visit("load_cell_sensitivity_v_n", self.load_cell_sensitivity_v_n, Range{0.001, 10.0},
          "[V/N] sensitivity; 100 N gives 10 V");
    visit("load_cell_offset_v", self.load_cell_offset_v, Range{-1.0, 1.0},
          "[V] offset of the bridge");
    visit("load_cell_noise_n_rthz", self.load_cell_noise_n_rthz, Range{0.0, 0.1},
          "[N/sqrt(Hz)] white noise density; assumed, 0.022 N RMS in 500 Hz");
    visit("encoder_counts_per_rev", self.encoder_counts_per_rev, Range{64.0, 10000000.0},
          "[counts/rev] counts in one turn; paper III-C (4096)");
    visit("inclinometer_step_rad", self.inclinometer_step_rad, Range{1e-7, 0.01},
          "[rad] resolution; 0.01 degree");
    visit("adc_range_v", self.adc_range_v, Range{1.0, 20.0}, "[V] input range, each side of zero");
    visit("adc_bits", self.adc_bits, Range{8.0, 24.0}, "[bit] resolution of the acquisition board");
  }
};

/// Sample of the acquisition board, in volts and counts.
struct RawSample {
  double accel_x_v = 0.0;           ///< [V] fore-aft
  double accel_y_v = 0.0;           ///< [V] lateral, + right
  double accel_z_v = 0.0;           ///< [V] vertical, + up; +1 g at rest
  double load_cell_v = 0.0;         ///< [V] force of hand on stick, + right
  std::int64_t encoder_counts = 0;  ///< [counts] + right
  double roll_rad = 0.0;            ///< [rad] inclinometer
};

/// True inputs of the sensors; frame and signs as in RawSample.
struct SensorInput {
  double accel_x_m_s2;
  double accel_y_m_s2;
  double accel_z_m_s2;  ///< specific force, + up
  double force_n;
  double theta_rad;
  double roll_rad;
};

/// Sensors and acquisition board.  Source: METHOD Eq. RG-9.
/// Config, seed and inputs determine the output.  Never allocates or throws.
class Sensors {
 public:
  struct Output {
    RawSample raw;
    Flags flags;  ///< kSaturated: a channel is at the end of its range
  };

  /// @throws stillhand::ConfigError if a field is outside its range.
  Sensors(const SensorConfig& config, std::uint64_t seed);

  Output step(const SensorInput& input) noexcept;

 private:
  /// Voltage, clipped to the range of the board and rounded to a code [V].
  [[nodiscard]] double converted(double volts, Flags& flags) const noexcept;
  double accelerometer(double accel_m_s2, Flags& flags) noexcept;

  SensorConfig config_;
  double adc_step_v_;
  double codes_per_v_;
  double accel_noise_v_;      ///< standard deviation of a sample
  double load_cell_noise_v_;  ///< same
  double counts_per_rad_;
  SensorNoise noise_;
};

}  // namespace stillhand::rig
