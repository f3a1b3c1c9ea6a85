// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "apps/study/explain/likelihood.hpp"

namespace stillhand::study {

/// The settings whose responses give the slopes: each calibrated mean below and above its value.
std::vector<Setting> slope_settings(const StudyOptions& study);

/// Slopes of the tables by the calibrated means, Eq. SU-9.
/// @param responses  of slope_settings(), in their order
Nuisance slopes_from(const std::vector<std::vector<Response>>& responses);

/// Both, with the simulation between them.  @param on_progress  share from 0 to 1
Nuisance slopes_of(StudyOptions study, std::size_t subjects, std::uint64_t seed, unsigned threads,
                   const std::function<bool(double share)>& on_progress);

}  // namespace stillhand::study
