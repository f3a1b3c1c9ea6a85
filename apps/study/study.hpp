// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <vector>

#include "apps/study/subject_session.hpp"

namespace stillhand::study {

/// Told of progress from the calling thread; @return false stops the study early.
using OnProgress = std::function<bool(std::int64_t done, std::int64_t all)>;

/// Every subject on all cores, in subject order; the same bits whatever the number of threads.
/// @throws ConfigError for options out of range, or what a subject's run throws (the first one's,
///         by index); Interrupted when on_progress said so.
std::vector<SubjectResult> run_study(const StudyOptions& options, const OnProgress& on_progress);

/// A study that was stopped before its end.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("stopped before the end; nothing was written") {}
};

/// Most subjects of one study: their results take about 55 kB each.
inline constexpr std::int64_t kMaxSubjects = 10000;

}  // namespace stillhand::study
