// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/study/subject_session.hpp"

namespace stillhand::study {

/// One complete tracking trial of a participant.
struct RecordedTrial {
  std::string participant;  ///< code
  std::string session;      ///< number or name of the session
  std::int64_t number = 0;  ///< in its session
  std::int64_t place = 0;   ///< counted from 1 over all complete tracking trials of the participant
  char condition = '?';     ///< A, B or C
  TrackedTrial tracked;
};

/// What recordings give besides the results of the participants.
struct RecordedSource {
  std::vector<std::string> participants;  ///< codes, one for each entry of StudyRecord::results
  std::vector<RecordedTrial> trials;      ///< all complete ones, also those not in the tables
  std::vector<std::string> left_out;      ///< one line each: trial or participant, and why
  std::string digest;                     ///< of the pre-registration, or empty
};

}  // namespace stillhand::study
