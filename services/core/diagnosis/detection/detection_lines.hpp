// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "services/core/diagnosis/detection/repeats.hpp"

namespace stillhand::diagnosis {

/// Lines of one group: harmonics of the excitation's lowest common frequency.
struct LineGroup {
  std::vector<double> frequency_hz;
  std::vector<double> output;    ///< [unit of the output] RMS of each line of the output
  std::vector<double> residual;  ///< of the residual
  std::vector<double> noise;     ///< RMS that noise would have: from the lines around it
  double share = 0.0;  ///< [-] of the residual's squares above the noise; below 0: less than that
  double p = 1.0;      ///< [-] that noise has such lines, Eq. DG-44; not corrected

  [[nodiscard]] bool empty() const noexcept { return frequency_hz.empty(); }
};

/// Detection lines of a multisine, Eq. DG-43 and DG-44: a linear system does not respond there.
/// Where only odd harmonics are excited, distortion of even order falls on even lines, of odd order
/// on odd ones.  Where even ones are excited too, the orders cannot be distinguished, and all lines
/// that are not excited are in `odd_or_even`.
/// Source: Pintelon and Schoukens, System Identification, 2nd ed., 2012 (nonlinear distortions);
/// Schoukens and Ljung, IEEE Control Systems 39(6), 2019.
struct DetectionLines {
  Periodicity periodicity;  ///< as used
  Repeats repeats;
  double fundamental_hz = 0.0;  ///< greatest common divisor of the excited lines
  bool odd_excitation = false;  ///< only odd multiples of it are excited
  LineGroup excited;  ///< for the figure: the model should explain it, effects may lie there
  LineGroup odd;
  LineGroup even;
  LineGroup odd_or_even;
};

/// Where the inputs repeat, and what they excite.
struct PeriodicExcitation {
  Periodicity periodicity;
  std::vector<std::size_t> excited;  ///< multiples of 1/period, ascending, not empty
};

/// Empty: the inputs don't repeat.
std::optional<PeriodicExcitation> periodic_excitation_of(const Signals& signals);

/// @param repeated  of the residual, over whole periods of the inputs
DetectionLines detection_lines(const RepeatedResidual& repeated,
                               const std::vector<std::size_t>& excited, const Signals& signals);

}  // namespace stillhand::diagnosis
