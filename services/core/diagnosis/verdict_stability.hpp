// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/diagnosis/diagnose.hpp"

/// How often a verdict comes back, METHOD Eq. DG-83.  Pure.
namespace stillhand::diagnosis {

/// The kind of the strongest effect that counts; without one, the verdict itself.
std::string in_one_word(const Diagnosis& diagnosis);

/// The recording for repetition i: a fifth of its blocks weighs nothing, and the output is off by
/// 1e-13 of itself.
Measurement disturbed(const Measurement& measurement, const std::string& output, int repetition);

/// Diagnoses the disturbed recording again and again, the same for the same arguments.
/// @param repetitions  at least 1
/// @throws as diagnose()
NameCounts verdict_stability(const Measurement& measurement, const DiagnoseOptions& options,
                             int repetitions);

}  // namespace stillhand::diagnosis
