// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/identification/record.hpp"

namespace stillhand::identification {

/// Whether a record can identify a model, METHOD Eq. ID-4.
struct Excitation {
  bool sufficient = false;
  std::string verdict;                 ///< one line for a person
  double acceleration_rms_m_s2 = 0.0;  ///< [m/s^2] about its mean
  double force_rms_n = 0.0;            ///< [N] about its mean
  int persistent_order = 0;  ///< [-] largest n with a well conditioned n x n covariance of a, <= 26
};

/// Never throws: says what is wrong instead (NaN, lengths, constant input, no force, too few
/// samples, a persistent excitation of less than 2 order + 1).
/// Source: Ljung, System Identification, 2nd ed., definition 13.2.
Excitation check_excitation(const Record& record, int order);

/// The same yes or no, without the figures where it is plainly yes.
/// @throws stillhand::ConfigError with the verdict when it is no.
void require_excitation(const Record& record, int order);

}  // namespace stillhand::identification
