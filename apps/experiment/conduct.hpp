// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/experiment/folder/folder.hpp"
#include "apps/lab/lab_options.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::experiment {

/// Participant that `run` takes without --participant: the first whose protocol is not complete and
/// who is not excluded; none: the experiment is over.
std::optional<std::size_t> next_participant(const Folder& folder);

/// Conducts one session of a participant over the bus, from the first step of the protocol that is
/// not done to the last, and writes each step into the journal when it is done.
/// @param lab  the options of this machine; protocol, participant, places are set here
/// @return exit status: 0 when the protocol is complete, 1 when something ended the session before
/// @throws ConfigError for what can be mended before a session
int conduct(const Folder& folder, std::size_t index, lab::LabOptions lab, runtime::Stop& stop);

/// Conducts a run of `stillhand plan-run` with a participant, next to the protocol: nothing of it
/// counts as a step.  Its recording and results are Folder::next_planned(), its line in the journal
/// is a note.
/// @param plan  plan.json
/// @return exit status as of `stillhand lab`
/// @throws ConfigError for what can be mended before
int conduct_planned(const Folder& folder, std::size_t index, const std::filesystem::path& plan,
                    lab::LabOptions lab, runtime::Stop& stop);

}  // namespace stillhand::experiment
