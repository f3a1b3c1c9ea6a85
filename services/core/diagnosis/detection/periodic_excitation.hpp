// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// Where the inputs repeat themselves: whole periods that follow each other without a gap.
struct Periodicity {
  std::size_t first = 0;   ///< sample
  std::size_t period = 0;  ///< [samples] whole; of a period that isn't, a multiple that nearly is
  std::size_t periods = 0;
  double deviation = 0.0;  ///< [-] of the inputs' power that doesn't repeat, the largest; Eq. DG-41

  [[nodiscard]] std::size_t end() const noexcept { return first + period * periods; }
};

/// Are the inputs periodic?  The lag at which all of them differ least from themselves, Eq. DG-41,
/// in the longest stretch; what comes before the periodic part and after it is cut off.  At least
/// two whole periods, and at most a hundredth of the power that doesn't repeat.
/// Source: Pintelon and Schoukens, System Identification: A Frequency Domain Approach, 2nd ed.
/// (periodic averaging). Pure.  Empty: not periodic, as far as this record shows.
std::optional<Periodicity> periodicity_of(const Signals& signals);

}  // namespace stillhand::diagnosis
