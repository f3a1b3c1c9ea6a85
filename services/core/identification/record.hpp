// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/signal/difference_model.hpp"

namespace stillhand::identification {

using signal::DifferenceModel;

/// A pegged trial: platform acceleration and stick force at one rate, equal lengths, no gaps.
struct Record {
  double rate_hz = 0.0;                   ///< [Hz]
  std::vector<double> acceleration_m_s2;  ///< a_y [m/s^2], platform, + right
  std::vector<double> force_n;            ///< f'_b [N], hand on stick, + right

  [[nodiscard]] std::size_t size() const noexcept { return force_n.size(); }
};

/// @throws stillhand::ConfigError when lengths differ, a sample isn't finite (its index is named)
/// or the rate isn't positive.
void check(const Record& record);

/// Samples [first, first + count) of a record.
Record part(const Record& record, std::size_t first, std::size_t count);

/// How well a model predicts a record, METHOD Eq. ID-3.
struct FitQuality {
  double one_step_rms_n = 0.0;        ///< [N] error given the measured past of f
  double one_step_vaf_percent = 0.0;  ///< [%] variance accounted for, the same
  double free_run_rms_n = 0.0;        ///< [N] error from the acceleration alone
  double free_run_vaf_percent = 0.0;  ///< [%]
  std::size_t samples = 0;            ///< [-] judged

  bool operator==(const FitQuality&) const = default;
};

/// Variance accounted for, Eq. ID-3: 100 (1 - var(f - f_hat) / var(f)) [%]; may be negative.
double vaf_percent(const std::vector<double>& measured, const std::vector<double>& predicted);
/// sqrt(mean((f - f_hat)^2)), in the unit of f.
double rms_difference(const std::vector<double>& measured, const std::vector<double>& predicted);

/// Judges a model on samples [first, end) of a record; the model runs from the record's start, so
/// that its transient from rest has died out before `first`.
FitQuality quality(const DifferenceModel& model, const Record& record, std::size_t first);

}  // namespace stillhand::identification
