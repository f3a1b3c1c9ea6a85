// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/study/subjects/subject_session.hpp"

namespace stillhand::study {

/// The mean over the trials of one participant and condition, METHOD Eq. SU-14.  One trial stays as
/// it is.  Pure.
/// @param trials  at least one, of one length, in their order
TrackedTrial averaged(const std::vector<const TrackedTrial*>& trials);

}  // namespace stillhand::study
