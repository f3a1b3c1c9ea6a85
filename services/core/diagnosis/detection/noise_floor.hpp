// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/diagnosis/detection/detection.hpp"
#include "services/core/diagnosis/fitting/screening.hpp"

namespace stillhand::diagnosis {

/// One estimate of the noise.
struct NoiseEstimate {
  std::string name;   ///< "repeats", "final model", "high frequencies", "between blocks"
  double rmse = 0.0;  ///< [unit of the output]
};

/// The size of the noise, METHOD "Noise floor".  No single estimate is reliable: the one that is
/// used, its interval, and all that exist.
struct NoiseFloor {
  double rmse = 0.0;
  double low = 0.0;
  double high = 0.0;
  std::string method;                    ///< which estimate it is, and what the others say
  std::vector<NoiseEstimate> estimates;  ///< the first is the one used
};

/// Bounds that held-out errors give.
struct ErrorBounds {
  double low = 0.0;  ///< [unit of the output] of the final model's held-out error, 95 %
  double high = 0.0;
  double impulse_response = 0.0;  ///< what DG-13 leaves; 0: unknown
};

/// Eq. DG-19 and DG-42, DG-47, DG-48.  @param after  answers to the same residual
NoiseFloor noise_floor_of(const DetectionResult& after, const Screening& screening,
                          const ErrorBounds& bounds);

}  // namespace stillhand::diagnosis
