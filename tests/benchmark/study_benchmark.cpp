// SPDX-License-Identifier: Apache-2.0
// How fast a study goes, and how it grows with the subjects.  Prints simulated seconds a second and
// the largest resident memory so far:
//   build/tests/study_benchmark --benchmark_repetitions=5 --benchmark_report_aggregates_only
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "apps/study/analysis.hpp"
#include "apps/study/study.hpp"

namespace stillhand::study {
namespace {

void whole_study(benchmark::State& state) {
  StudyOptions options;
  options.subjects = state.range(0);
  options.protocol.conditions = session::parse_conditions("A,B,C");
  options.protocol.identify_s = 120.0;
  for (auto _ : state) {
    const auto results = run_study(options, [](std::int64_t, std::int64_t) { return true; });
    benchmark::DoNotOptimize(analyse(results));
  }
  const double simulated_s = static_cast<double>(options.subjects) *
                             (options.protocol.identify_s + 3.0 * options.protocol.trial_s) *
                             static_cast<double>(state.iterations());
  state.counters["simulated_s_per_s"] =
      benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["resident_MiB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
}
BENCHMARK(whole_study)
    ->Arg(1)
    ->Arg(12)
    ->Arg(100)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace stillhand::study

BENCHMARK_MAIN();
