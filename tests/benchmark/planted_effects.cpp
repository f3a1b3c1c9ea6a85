// SPDX-License-Identifier: Apache-2.0
// Plants effects, seals the label, asks the engine, opens the label: confusion matrix, false alarms
// and what is left over the noise.
//   build/bin/planted_effects                 504 recordings with one effect at 10 and 25 % of the
//                                             force, 200 with none; 40 with two
//   build/bin/planted_effects --tenth         every tenth of them, and exit 1 where too many are
//   wrong
// Recordings are those of tests/planted with the plan's seed; README there says what is drawn.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "diagnosis/core/diagnose.hpp"
#include "planted/series.hpp"
#include "planted/to_measurement.hpp"

namespace {

using namespace stillhand;

struct Case {
  std::uint64_t seed = 0;
  planted::Spec spec;
  planted::Truth truth;
  std::vector<std::string> found;
  double left_over_noise = 0.0;
  std::string failure;
};

std::vector<Case> cases_of(const planted::SeriesPlan& plan, std::size_t count, std::size_t step) {
  std::vector<Case> cases;
  for (std::size_t i = 0; i < count; i += step) {
    const auto [seed, spec] = plan.at(i);
    cases.push_back({seed, spec, {}, {}, 0.0, {}});
  }
  return cases;
}

void ask(Case& each) {
  const planted::Draft draft = planted::draw(each.seed, each.spec);
  each.truth = draft.truth;
  try {
    const auto verdict = diagnosis::diagnose(planted::to_measurement(draft.recording), {});
    for (const auto& effect : verdict.effects) each.found.push_back(effect.effect.kind);
    each.left_over_noise = verdict.final_error.rmse / draft.truth.noise_rms_n;
  } catch (const std::exception& error) {
    each.failure = error.what();
  }
}

void ask_all(std::vector<Case>& cases, const char* what) {
  std::atomic<std::size_t> next{0};
  std::mutex printing;
  const auto work = [&] {
    for (std::size_t i = 0; (i = next++) < cases.size();) {
      ask(cases[i]);
      const std::lock_guard lock(printing);
      std::fprintf(stderr, "\r%s %zu of %zu   ", what, i + 1, cases.size());
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) others.emplace_back(work);
    work();
  }
  std::fputc('\n', stderr);
}

std::string kind_name(planted::Kind kind) {
  return std::string(planted::kKindNames[static_cast<std::size_t>(kind)]);
}

// Right: the first effect's kind is the planted one, or one that the generator says is as right.
bool right(const Case& each) {
  if (each.found.empty() || each.truth.effects.empty()) return false;
  return each.found.front() == kind_name(each.truth.effects.front().kind);
}

struct Tally {
  std::size_t right = 0;
  std::size_t all = 0;
};

void print_matrix(const std::vector<Case>& cases) {
  std::map<std::string, std::map<std::string, std::size_t>> matrix;
  for (const Case& each : cases) {
    const std::string planted =
        each.truth.effects.empty() ? "none" : kind_name(each.truth.effects[0].kind);
    const std::string found = !each.failure.empty() ? "error"
                              : each.found.empty()  ? "nothing missing"
                                                    : each.found.front();
    ++matrix[planted][found];
  }
  std::printf("| planted | named |\n| --- | --- |\n");
  for (const auto& [planted, row] : matrix) {
    std::printf("| %s |", planted.c_str());
    for (const auto& [found, count] : row) std::printf(" %s %zu", found.c_str(), count);
    std::printf(" |\n");
  }
}

void print_misses(const std::vector<Case>& cases) {
  for (const Case& each : cases) {
    const bool none = each.truth.effects.empty();
    if (each.failure.empty() && (none ? each.found.empty() : right(each))) continue;
    std::printf("seed %llu: %s (%s), %.0f dB, evidence %.0f; named",
                static_cast<unsigned long long>(each.seed),
                none ? "none" : kind_name(each.truth.effects[0].kind).c_str(),
                none ? each.truth.noise.c_str() : each.truth.effects[0].variant.c_str(),
                each.truth.snr_db, each.truth.evidence);
    for (const std::string& kind : each.found) std::printf(" %s", kind.c_str());
    std::printf("%s\n", each.failure.c_str());
  }
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

Tally tally(const std::vector<Case>& cases) {
  return {static_cast<std::size_t>(std::ranges::count_if(cases, right)), cases.size()};
}

}  // namespace

int main(int argc, char** argv) {
  const bool tenth = argc > 1 && std::strcmp(argv[1], "--tenth") == 0;
  const std::size_t step = tenth ? 10 : 1;
  planted::SeriesPlan singles;
  singles.kinds.assign(planted::kKindNames.begin(), planted::kKindNames.end());
  planted::SeriesPlan none;
  none.kinds = {"none"};
  none.seed = 2;
  planted::SeriesPlan pairs = singles;
  pairs.together = 2;
  pairs.seed = 3;
  // A step of ten meets every other kind only; eleven meets them all.
  auto one = cases_of(singles, 504, tenth ? 11 : 1);
  auto nothing = cases_of(none, 200, step);
  auto two = cases_of(pairs, 40, step);
  ask_all(one, "one effect");
  ask_all(nothing, "none");
  ask_all(two, "two effects");

  const Tally single = tally(one);
  const auto alarms = static_cast<std::size_t>(
      std::ranges::count_if(nothing, [](const Case& each) { return !each.found.empty(); }));
  const auto failures = static_cast<std::size_t>(
      std::ranges::count_if(one, [](const Case& each) { return !each.failure.empty(); }));
  std::size_t both = 0;
  std::size_t in_order = 0;
  for (const Case& each : two) {
    std::vector<std::string> truth;
    for (const auto& effect : each.truth.effects) truth.push_back(kind_name(effect.kind));
    std::vector<std::string> named(
        each.found.begin(),
        each.found.begin() + std::min<std::ptrdiff_t>(2, std::ssize(each.found)));
    if (named == truth) ++in_order;
    std::ranges::sort(named);
    std::ranges::sort(truth);
    if (named == truth) ++both;
  }
  std::vector<double> left;
  for (const Case& each : one) left.push_back(each.left_over_noise);
  std::printf("one effect: %zu of %zu named right (%.1f %%)\n", single.right, single.all,
              100.0 * static_cast<double>(single.right) / static_cast<double>(single.all));
  std::printf("none: %zu false alarms of %zu (%.1f %%)\n", alarms, nothing.size(),
              100.0 * static_cast<double>(alarms) / static_cast<double>(nothing.size()));
  std::printf("two effects: both named in %zu of %zu, strongest first in %zu\n", both, two.size(),
              in_order);
  std::printf("held-out error over noise: median %.3f, 90 %% below %.3f, largest %.3f\n\n",
              quantile(left, 0.5), quantile(left, 0.9), quantile(left, 1.0));
  print_matrix(one);
  print_matrix(nothing);
  std::printf("\n");
  print_misses(one);
  print_misses(nothing);
  if (!tenth) return 0;
  // A guard against steps back: 41 of 46 were right and none of 20 an alarm on 2026-11-21.  The
  // goal for the whole is 95 % and below 2 %.
  const bool good = single.right >= 39 && alarms <= 1 && failures == 0;
  if (!good) std::printf("too many are wrong\n");
  return good ? 0 : 1;
}
