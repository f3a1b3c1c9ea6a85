// SPDX-License-Identifier: Apache-2.0
// How fast a study goes on one and two threads, next to its arithmetic alone.  Prints simulated
// seconds a second and the largest resident memory so far:
//   build/tests/study_benchmark --benchmark_repetitions=5 --benchmark_report_aggregates_only
// study_growth.py shows how time and memory grow with the subjects.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "apps/study/analysis.hpp"
#include "apps/study/study.hpp"

namespace stillhand::study {
namespace {

StudyOptions paper_options(std::int64_t subjects) {
  StudyOptions options;
  options.subjects = subjects;
  options.protocol.conditions = session::parse_conditions("A,B,C");
  options.protocol.identify_s = 120.0;
  return options;
}

void count(benchmark::State& state, const StudyOptions& options) {
  const double simulated_s = static_cast<double>(options.subjects) *
                             (options.protocol.identify_s + 3.0 * options.protocol.trial_s) *
                             static_cast<double>(state.iterations());
  state.counters["simulated_s_per_s"] =
      benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["resident_MiB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void whole_study(benchmark::State& state) {
  StudyOptions options = paper_options(state.range(0));
  options.threads = static_cast<unsigned>(state.range(1));
  for (auto _ : state) {
    const auto results = run_study(options, [](std::int64_t, std::int64_t) { return true; });
    benchmark::DoNotOptimize(analyse(results));
  }
  count(state, options);
}
BENCHMARK(whole_study)
    ->ArgNames({"subjects", "threads"})
    ->Args({12, 1})
    ->Args({12, 2})
    ->Args({100, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

// The steps of all cores over the same trials of one subject on one thread: no identification, no
// metrics, no subjects to draw.  The motor stays off, because there is no model.
void arithmetic_alone(benchmark::State& state) {
  const StudyOptions options = paper_options(1);
  for (auto _ : state) {
    session::InProcessLoop loop(session::CoreConfigs{}, options.seed, 10);
    for (const auto& planned : session::plan(options.protocol)) {
      benchmark::DoNotOptimize(loop.run(planned));
    }
  }
  count(state, options);
}
BENCHMARK(arithmetic_alone)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace stillhand::study

BENCHMARK_MAIN();
