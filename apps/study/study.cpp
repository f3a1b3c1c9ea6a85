// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study.hpp"

#include <algorithm>

#include "services/contract/config_error.hpp"
#include "services/runtime/process/run_jobs.hpp"

namespace stillhand::study {
namespace {

// The mean model of all subjects but `left_out`: one least-squares fit to their records, Eq. ID-18.
identification::FeedthroughModel mean_model(const std::vector<SubjectResult>& results,
                                            std::size_t left_out) {
  std::vector<identification::ArxFactor> factors;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (i != left_out) factors.push_back(results[i].identification.factor);
  }
  identification::FeedthroughModel model;
  model.fit = identification::fit_pooled(factors);
  model.control = identification::to_control_rate(model.fit).model;
  return model;
}

void run_wrong(const StudyOptions& options, std::vector<SubjectResult>& results,
               std::size_t index) {
  SubjectResult& own = results[index];
  const SubjectResult& other = results[(index + 1) % results.size()];
  const auto at = static_cast<std::int64_t>(index);
  own.wrong['O'] = run_with_model(options, own, at, used_model(other.identification));
  own.wrong['M'] = run_with_model(options, own, at, mean_model(results, index));
}

void check_wrong_models(const StudyOptions& options) {
  if (!options.wrong_models) return;
  if (options.subjects < 2) {
    throw ConfigError("--wrong-models", "1 subject", "2 or more subjects");
  }
  const auto& conditions = options.protocol.conditions;
  for (const auto needed : {session::Condition::kB, session::Condition::kC}) {
    if (std::find(conditions.begin(), conditions.end(), needed) == conditions.end()) {
      throw ConfigError("--wrong-models", std::string("no condition ") + name_of(needed),
                        "conditions B and C, because their difference is a model's gain");
    }
  }
}

void run_for_all(const StudyOptions& options, std::size_t count, const auto& job,
                 const OnProgress& on_progress) {
  const auto threads =
      options.threads > 0 ? static_cast<unsigned>(options.threads) : runtime::core_count();
  const auto on_done = [&](std::size_t done) {
    return on_progress(static_cast<std::int64_t>(done), static_cast<std::int64_t>(count));
  };
  if (!runtime::run_jobs(count, threads, job, on_done)) throw Interrupted();
}

}  // namespace

std::vector<SubjectResult> run_subjects(const StudyOptions& options, std::int64_t first,
                                        std::int64_t end, const OnProgress& on_progress) {
  if (options.subjects < 1 || options.subjects > kMaxSubjects) {
    throw ConfigError("--subjects", std::to_string(options.subjects),
                      "1 to " + std::to_string(kMaxSubjects));
  }
  check_wrong_models(options);
  session::plan(options.protocol);  // checks the lengths
  for (std::int64_t index = first; index < end; ++index) check_subject(options, index);
  std::vector<SubjectResult> results(static_cast<std::size_t>(end - first));
  const auto job = [&](std::size_t at) {
    results[at] = run_subject(options, first + static_cast<std::int64_t>(at));
  };
  run_for_all(options, results.size(), job, on_progress);
  return results;
}

void run_wrong_models(const StudyOptions& options, std::vector<SubjectResult>& results,
                      const OnProgress& on_progress) {
  if (!options.wrong_models) return;
  const auto job = [&](std::size_t index) { run_wrong(options, results, index); };
  run_for_all(options, results.size(), job, on_progress);
}

std::vector<SubjectResult> run_study(const StudyOptions& options, const OnProgress& on_progress) {
  const std::int64_t count = options.subjects;
  const std::int64_t all = options.wrong_models ? 2 * count : count;
  auto results = run_subjects(
      options, 0, count, [&](std::int64_t done, std::int64_t) { return on_progress(done, all); });
  run_wrong_models(options, results,
                   [&](std::int64_t done, std::int64_t) { return on_progress(count + done, all); });
  return results;
}

}  // namespace stillhand::study
