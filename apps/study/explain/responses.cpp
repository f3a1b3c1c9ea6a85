// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/responses.hpp"

#include <algorithm>
#include <limits>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::study {
namespace {

Response response_of(const SubjectResult& result) {
  Response out;
  std::size_t at = 0;
  for (const Condition condition : kPaperConditions) {
    const TrackedTrial& trial = result.trials.at(condition);
    for (const auto& metric : session::kMetrics) out.metrics[at++] = metric.of(trial);
  }
  const TrackedTrial& cancelled = result.trials.at(kC);
  out.observed = {cancelled.counterforce_delay_s,
                  cancelled.cancelled_share,
                  cancelled.feedthrough_rms_n / result.trials.at(kB).feedthrough_rms_n,
                  result.identification.paper.heldout.free_run_vaf_percent,
                  cancelled.motor_rms_n / cancelled.feedthrough_rms_n,
                  static_cast<double>(std::ranges::find(result.order, kC) -
                                      std::ranges::find(result.order, kB))};
  return out;
}

Response response_to(const StudyOptions& options, std::size_t subject) {
  try {
    return response_of(run_subject(options, static_cast<std::int64_t>(subject)));
  } catch (const ConfigError&) {
    Response none;
    none.metrics.fill(std::numeric_limits<double>::quiet_NaN());
    return none;
  }
}

}  // namespace

std::vector<Metrics> metrics_of(const std::vector<Response>& responses) {
  std::vector<Metrics> out;
  out.reserve(responses.size());
  for (const Response& response : responses) out.push_back(response.metrics);
  return out;
}

std::vector<std::vector<Response>> run_settings(const std::vector<Setting>& settings,
                                                std::size_t subjects, unsigned threads,
                                                const OnProgress& on_progress) {
  std::vector<std::vector<Response>> out(settings.size(), std::vector<Response>(subjects));
  const std::size_t jobs = settings.size() * subjects;
  const auto job = [&](std::size_t index) {
    const std::size_t setting = index / subjects;
    const std::size_t subject = index % subjects;
    out[setting][subject] = response_to(settings[setting].options, subject);
  };
  const auto done = [&](std::size_t count) {
    return on_progress(static_cast<std::int64_t>(count), static_cast<std::int64_t>(jobs));
  };
  const unsigned workers = threads > 0 ? threads : runtime::core_count();
  if (!runtime::run_jobs(jobs, workers, job, done)) throw Interrupted();
  return out;
}

}  // namespace stillhand::study
