// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/experiment/file/standing.hpp"
#include "apps/study/subjects/conditions.hpp"

namespace stillhand::study {

/// What an experiment registered for its analysis before the first participant.
struct Registration {
  experiment::Exclusion rules;
  std::int64_t trials_a_condition = 1;                       ///< planned for each participant
  std::vector<Condition> conditions;                         ///< planned
  std::vector<std::pair<Condition, Condition>> comparisons;  ///< first, second
  double alpha = 0.05;                                       ///< of all comparisons together
  experiment::Design design;                                 ///< the whole of it
  experiment::Standing standing;                             ///< who is complete, when unblinded
  std::filesystem::path folder;                              ///< of the experiment
};

/// The registration of the one folder with an experiment.yaml among `folders`; none without one.
/// @param digest  of the pre-registration, as the recordings state it
/// @throws ConfigError for an experiment.yaml of another digest, and one that cannot be read
std::optional<Registration> registration_of(const std::vector<std::filesystem::path>& folders,
                                            const std::string& digest);

}  // namespace stillhand::study
