// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "services/core/diagnosis/detection/detection.hpp"

namespace stillhand::diagnosis {

/// A residual that no kind explains.
struct Unexplained {
  std::string what;  ///< one sentence
  std::array<double, 2> band_hz{};
  std::vector<double> times_s;        ///< [s] where it is strongest
  std::vector<std::string> channels;  ///< measured ones, three at most
};

/// What the detection still finds in the residual of a final model; nothing: every question is
/// answered no.  `what` is the first answer, `band_hz` holds the middle 80 % of the residual's
/// power, `times_s` are the three parts of the record with the largest residual.
std::optional<Unexplained> unexplained_of(const DetectionResult& detections,
                                          const Screening& screening);

}  // namespace stillhand::diagnosis
