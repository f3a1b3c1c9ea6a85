// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <vector>

#include "apps/study/subjects/subject_session.hpp"

namespace stillhand::study {

/// Reports progress, on the calling thread.  @return false to stop the study early
using OnProgress = std::function<bool(std::int64_t done, std::int64_t all)>;

/// Runs every subject on all cores.  The results are in subject order, with the same bits for any
/// number of threads.
/// @throws ConfigError for options out of range; the exception of the first subject, by index, that
///         fails; Interrupted when on_progress returned false.
std::vector<SubjectResult> run_study(const StudyOptions& options, const OnProgress& on_progress);

/// A study that was stopped before its end.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("stopped before the end; nothing was written") {}
};

/// Most subjects of one study: their results take about 55 kB each.
inline constexpr std::int64_t kMaxSubjects = 10000;

}  // namespace stillhand::study
