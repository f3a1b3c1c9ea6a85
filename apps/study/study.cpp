// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "services/contract/config_error.hpp"

namespace stillhand::study {
namespace {

using std::chrono::milliseconds;

// Runs job(0) .. job(count - 1) on several threads, each index once.
void run_all(std::int64_t count, unsigned threads, const std::function<void(std::int64_t)>& job,
             const std::function<bool(std::int64_t)>& on_done) {
  std::atomic<std::int64_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::condition_variable changed;
  std::int64_t done = 0;
  unsigned running = threads;
  std::int64_t failed_at = count;
  std::exception_ptr failure;

  const auto work = [&] {
    while (!stop) {
      const std::int64_t index = next++;
      if (index >= count) break;
      std::exception_ptr caught;
      try {
        job(index);
      } catch (...) {
        caught = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      ++done;
      if (caught && index < failed_at) {
        failed_at = index;
        failure = caught;
        stop = true;
      }
      changed.notify_one();
    }
    const std::lock_guard lock(mutex);
    --running;
    changed.notify_one();
  };
  bool interrupted = false;
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < threads; ++i) workers.emplace_back(work);
    std::unique_lock lock(mutex);
    while (running > 0) {
      changed.wait_for(lock, milliseconds(100));
      const std::int64_t so_far = done;
      lock.unlock();
      if (!stop && !on_done(so_far)) {
        interrupted = true;
        stop = true;
      }
      lock.lock();
    }
  }
  if (failure) std::rethrow_exception(failure);
  if (interrupted) throw Interrupted();
}

// The mean model of all subjects but `left_out`: one least-squares fit to their records, Eq. ID-18.
signal::DifferenceModel mean_model(const std::vector<SubjectResult>& results,
                                   std::size_t left_out) {
  std::vector<identification::ArxFactor> factors;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (i != left_out) factors.push_back(results[i].identification.factor);
  }
  return identification::to_control_rate(identification::fit_pooled(factors)).model;
}

void run_wrong_models(const StudyOptions& options, std::vector<SubjectResult>& results,
                      std::size_t index) {
  SubjectResult& own = results[index];
  const SubjectResult& other = results[(index + 1) % results.size()];
  const auto at = static_cast<std::int64_t>(index);
  own.wrong['O'] = run_with_model(options, own, at, other.identification.control.model);
  own.wrong['M'] = run_with_model(options, own, at, mean_model(results, index));
}

void check_wrong_models(const StudyOptions& options) {
  if (!options.wrong_models) return;
  if (options.subjects < 2) {
    throw ConfigError("--wrong-models", "1 subject", "2 or more subjects");
  }
  const auto& conditions = options.protocol.conditions;
  for (const auto needed : {session::Condition::kMoving, session::Condition::kMovingCancelled}) {
    if (std::find(conditions.begin(), conditions.end(), needed) == conditions.end()) {
      throw ConfigError("--wrong-models", std::string("no condition ") + static_cast<char>(needed),
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
  for (std::int64_t index = 0; index < options.subjects; ++index) check_subject(options, index);
  const std::int64_t count = options.subjects;
  const std::int64_t all = options.wrong_models ? 2 * count : count;
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const auto threads = static_cast<unsigned>(
      std::min<std::int64_t>(count, options.threads > 0 ? options.threads : cores));
  std::vector<SubjectResult> results(static_cast<std::size_t>(count));
  run_all(
      count, threads,
      [&](std::int64_t index) {
        results[static_cast<std::size_t>(index)] = run_subject(options, index);
      },
      [&](std::int64_t done) { return on_progress(done, all); });
  if (options.wrong_models) {
    run_all(
        count, threads,
        [&](std::int64_t index) {
          run_wrong_models(options, results, static_cast<std::size_t>(index));
        },
        [&](std::int64_t done) { return on_progress(count + done, all); });
  }
  return results;
}

}  // namespace stillhand::study
