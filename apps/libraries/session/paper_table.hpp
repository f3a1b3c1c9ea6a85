// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "services/core/identification/tracking_metrics.hpp"

namespace stillhand::session {

/// Assumed size of a unit of the paper's RMS error [mm]; apps/study/METHOD.md, "The paper's unit".
inline constexpr double kPaperUnit_mm = 5.5;

/// One of the paper's three metrics, and what its Tables I and II give (means of 12 subjects).
struct Metric {
  const char* key;              ///< in summary.json
  const char* restoration_key;  ///< in summary.json
  const char* title;
  double (*of)(const identification::TrackingMetrics&);
  double paper_a, paper_b, paper_c;
  double paper_restored_percent;  ///< (B - C) / (B - A)
  double paper_p_ab, paper_p_bc;  ///< of the paired t-tests, 11 degrees of freedom
  double paper_unit = 1.0;        ///< of paper_a to paper_c, in the unit of the title

  /// Of A, B and C, in the unit of the title.
  [[nodiscard]] constexpr std::array<double, 3> paper_means() const noexcept {
    return {paper_unit * paper_a, paper_unit * paper_b, paper_unit * paper_c};
  }
};

inline constexpr std::array<Metric, 3> kMetrics{{
    {"rms_error_mm", "rms_error", "RMS error [mm]",
     [](const identification::TrackingMetrics& m) { return m.rms_error_mm; }, 4.04, 9.62, 7.01,
     47.0, 1.79e-9, 4.05e-6, kPaperUnit_mm},
    {"dwell_ratio", "dwell_ratio", "dwell ratio [-]",
     [](const identification::TrackingMetrics& m) { return m.dwell_ratio; }, 0.48, 0.23, 0.31, 32.0,
     1.5e-12, 4.07e-5},
    {"crossover_hz", "crossover", "crossover f_c [Hz]",
     [](const identification::TrackingMetrics& m) { return m.crossover_hz; }, 0.25, 0.10, 0.14,
     27.0, 5.67e-7, 0.0047},
}};

}  // namespace stillhand::session
