// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillhand::study {

/// One recording, and whose it is.
struct SessionFile {
  std::filesystem::path path;  ///< session.mcap
  std::string participant;     ///< code; of a session outside an experiment its folder's name
  std::string session;
  std::string digest;    ///< of the experiment's pre-registration, or empty
  std::string excluded;  ///< why the experimenter excluded the participant, or empty
};

/// The recordings of session folders (with session.mcap) and of experiment folders (with
/// participants/*/sessions/*/session.mcap), sorted by participant, then session.  Whose a recording
/// is states its metadata record `stillhand.experiment`.
/// @throws ConfigError for an experiment that is still blinded, a folder without a session, a
/// session folder without session.mcap, a
///         file that is no MCAP, two recordings of one participant and session, recordings of two
///         experiments, and an experiment's folder of another participant than the recording's
std::vector<SessionFile> find_sessions(const std::vector<std::filesystem::path>& folders);

}  // namespace stillhand::study
