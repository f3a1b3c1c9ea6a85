// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "apps/study/recorded/find_sessions.hpp"
#include "apps/study/report/output.hpp"
#include "apps/study/subjects/study.hpp"

namespace stillhand::study {

/// Fills results, source and lengths of a record from recordings.  The sessions of a participant
/// join; of each condition the mean over the complete trials counts (Eq. SU-14), and the last
/// complete pegged trial.  A participant who lacks the pegged trial, or a condition that most
/// others have, is left out with the reason.  With a registration the results are those of its
/// exclusion rules, and RecordedSource::registered has the selection without them.
/// @param files  find_sessions()
/// @throws ConfigError for a recording that cannot be read, trials of unequal
///         lengths, and if no participant is complete; Interrupted
void read_recorded(const std::vector<SessionFile>& files,
                   const std::optional<Registration>& registration, StudyRecord& record,
                   const OnProgress& on_progress);

}  // namespace stillhand::study
