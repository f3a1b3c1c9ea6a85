// SPDX-License-Identifier: Apache-2.0
#include "apps/study/subjects/study.hpp"

#include <algorithm>

#include "services/core/contract/config_error.hpp"
#include "services/system/process/run_jobs.hpp"

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

}  // namespace

std::vector<SubjectResult> run_study(const StudyOptions& options, const OnProgress& on_progress) {
  if (options.subjects < 1 || options.subjects > kMaxSubjects) {
    throw ConfigError("--subjects", std::to_string(options.subjects),
                      "1 to " + std::to_string(kMaxSubjects));
  }
  check_wrong_models(options);
  session::plan(options.protocol);  // checks the lengths
  const std::int64_t count = options.subjects;
  for (std::int64_t index = 0; index < count; ++index) check_subject(options, index);
  std::vector<SubjectResult> results(static_cast<std::size_t>(count));
  const std::int64_t all = options.wrong_models ? 2 * count : count;
  const auto run_for_all = [&](std::int64_t done_before, const auto& job) {
    const auto threads =
        options.threads > 0 ? static_cast<unsigned>(options.threads) : runtime::core_count();
    const auto on_done = [&](std::size_t done) {
      return on_progress(done_before + static_cast<std::int64_t>(done), all);
    };
    if (!runtime::run_jobs(results.size(), threads, job, on_done)) throw Interrupted();
  };
  run_for_all(0, [&](std::size_t at) {
    results[at] = run_subject(options, static_cast<std::int64_t>(at));
  });
  // They need the models of all.
  if (options.wrong_models) {
    run_for_all(count, [&](std::size_t at) { run_wrong(options, results, at); });
  }
  return results;
}

}  // namespace stillhand::study
