// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/diagnosis/diagnose.hpp"

namespace stillhand::diagnose {

/// out.json, README: verdict, errors, effects and what is unexplained; the baseline's parameters,
/// the interval of the noise floor, ties and notes.
std::string diagnosis_json(const diagnosis::Diagnosis& diagnosis);

/// The same for people: a short table.
std::string diagnosis_table(const diagnosis::Diagnosis& diagnosis);

}  // namespace stillhand::diagnose
