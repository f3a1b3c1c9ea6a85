// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/recording/experiment_record.hpp"
#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::command_line {
class Command;
}

namespace stillhand::recording {

/// The place of a recording in an experiment (apps/experiment).  A participant is a code: no name
/// of a person goes into a recording.
struct OfExperiment {
  std::string participant;  ///< code, for example "P07"; empty: the recording is of no experiment
  std::string digest;       ///< SHA-256 of experiment.yaml, 64 hexadecimal digits
  std::string session;      ///< of this participant: "01", "02", ...

  bool operator==(const OfExperiment&) const = default;
};

/// Adds --participant, --experiment-digest and --experiment-session; parsing sets `place`.
void add_experiment_options(command_line::Command& cli, OfExperiment& place);

/// The place as words of a command line; none for no experiment.
std::vector<std::string> experiment_words(const OfExperiment& place);

/// Content of the metadata record: "participant", "digest", "session".
TextMap experiment_texts(const OfExperiment& place);

}  // namespace stillhand::recording
