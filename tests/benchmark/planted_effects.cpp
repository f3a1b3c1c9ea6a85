// SPDX-License-Identifier: Apache-2.0
// Plants effects, seals the label, asks the engine, opens the label: confusion matrix, false alarms
// and what is left over the noise.
//   build/tests/planted_effects            504 recordings with one effect at 10 or 25 % of the
//                                          force, 72 at 5 %, 200 with none, 40 with two
//   build/tests/planted_effects --tenth    every tenth of them, and exit 1 where too many are wrong
//   build/tests/planted_effects --short    nine with one effect and two with none, exit 1 likewise
//   build/tests/planted_effects --only 1 7 the eighth recording of the first list, in detail
// Recordings are those of tests/planted with the plan's seed; README there says what is drawn.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/system/command_line/command_line.hpp"
#include "tests/benchmark/on_all_cores.hpp"
#include "tests/planted/series.hpp"
#include "tests/planted/to_measurement.hpp"

namespace {

using namespace stillhand;

// The four lists, by the seed of their plan.
enum List : std::uint64_t { kSingles = 1, kNone = 2, kPairs = 3, kWeak = 4 };

planted::SeriesPlan plan_of(std::uint64_t list) {
  planted::SeriesPlan plan;
  plan.seed = list;
  plan.kinds.assign(planted::kKindNames.begin(), planted::kKindNames.end());
  if (list == kNone) plan.kinds = {"none"};
  if (list == kPairs) plan.together = 2;
  if (list == kWeak) plan.strengths = {0.05};
  return plan;
}

struct Case {
  std::uint64_t list = 0;
  std::size_t index = 0;
  std::uint64_t seed = 0;
  planted::Spec spec;
  planted::Truth truth;
  std::vector<std::string> found;
  double left_over_noise = 0.0;
  std::string failure;
};

std::vector<Case> cases_of(std::uint64_t list, std::size_t count, std::size_t step) {
  const planted::SeriesPlan plan = plan_of(list);
  std::vector<Case> cases;
  for (std::size_t i = 0; i < count; i += step) {
    const auto [seed, spec] = plan.at(i);
    cases.push_back({list, i, seed, spec, {}, {}, 0.0, {}});
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
  std::mutex printing;
  const bool terminal = isatty(STDERR_FILENO) != 0;
  benchmark::on_all_cores(cases.size(), [&](std::size_t i) {
    ask(cases[i]);
    if (!terminal) return;
    const std::lock_guard lock(printing);
    std::fprintf(stderr, "\r%s %zu of %zu   ", what, i + 1, cases.size());
  });
  if (terminal) std::fputc('\n', stderr);
}

std::string kind_name(planted::Kind kind) {
  return std::string(planted::kKindNames[static_cast<std::size_t>(kind)]);
}

// Right: the first effect's kind is the planted one.
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
    std::printf("%zu %zu: %s (%s), %.0f dB, evidence %.0f; named", each.list, each.index,
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

std::size_t alarms(const std::vector<Case>& cases) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cases, [](const Case& each) { return !each.found.empty(); }));
}

double percent(std::size_t part, std::size_t whole) {
  return 100.0 * static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
}

void print_singles(const char* what, const std::vector<Case>& cases) {
  const Tally all = tally(cases);
  std::vector<double> left;
  left.reserve(cases.size());
  for (const Case& each : cases) left.push_back(each.left_over_noise);
  const auto within = static_cast<std::size_t>(
      std::ranges::count_if(left, [](double ratio) { return ratio <= 1.2; }));
  std::printf("%s: %zu of %zu named right (%.1f %%); held-out error over noise: median %.3f, ",
              what, all.right, all.all, percent(all.right, all.all), quantile(left, 0.5));
  std::printf("90 %% below %.3f, %zu above 1.2, largest %.3f\n", quantile(left, 0.9),
              left.size() - within, quantile(left, 1.0));
}

void print_pairs(const std::vector<Case>& cases) {
  std::size_t both = 0;
  std::size_t in_order = 0;
  for (const Case& each : cases) {
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
  std::printf("two effects: both named in %zu of %zu, strongest first in %zu\n", both, cases.size(),
              in_order);
}

// The recording of one seed: what was planted, and all that was tried.
void print_one(std::uint64_t list, std::size_t i) {
  const auto [seed, spec] = plan_of(list).at(i);
  const planted::Draft draft = planted::draw(seed, spec);
  for (const auto& effect : draft.truth.effects) {
    std::printf("planted: %s (%s), strength %.3f, noise %.4f N, evidence %.0f\n",
                kind_name(effect.kind).c_str(), effect.variant.c_str(), effect.strength,
                draft.truth.noise_rms_n, draft.truth.evidence);
    for (const auto& parameter : effect.parameters) {
      std::printf("   %s=%.4g", parameter.name.c_str(), parameter.value);
    }
    std::printf("\n");
  }
  const auto verdict = diagnosis::diagnose(planted::to_measurement(draft.recording), {});
  std::printf("baseline: order %zu, %.4f N held out, impulse response %.4f N\n",
              verdict.baseline.model.body.order(), verdict.baseline_error.rmse,
              verdict.baseline.impulse_response_rmse);
  const auto print_tried = [](const std::vector<diagnosis::Trial>& tried) {
    for (std::size_t k = 0; k < std::min<std::size_t>(12, tried.size()); ++k) {
      const auto& effect = tried[k].model.effects.back();
      std::printf("   %.4f N  %2zu numbers  %s (%s)", tried[k].rmse, complexity(tried[k].model),
                  effect.kind.c_str(), effect.form.c_str());
      for (const std::string& channel : effect.channels) std::printf(" %s", channel.c_str());
      for (const auto& parameter : effect.parameters) {
        std::printf(" %s=%.4g", parameter.name.c_str(), parameter.value);
      }
      std::printf("\n");
    }
  };
  for (const auto& addition : verdict.search.additions) {
    const auto& chosen = addition.tried[addition.chosen].model.effects.back();
    std::printf("added %s (%s), p %.2g\n", chosen.kind.c_str(), chosen.form.c_str(),
                addition.comparison.p);
    print_tried(addition.tried);
  }
  std::printf("rejected after it\n");
  print_tried(verdict.search.last_tried);
  for (const auto& detection : verdict.after.detections) {
    if (detection.share < 0.02) break;
    std::printf("left: %s %s, share %.3f, p %.2g\n", detection.question.c_str(),
                detection.channel.c_str(), detection.share, detection.p);
  }
}

/// Which recordings of the lists are asked, and what a guard against steps back demands of them.
struct Selection {
  std::size_t singles_step = 1;
  std::size_t weak = 72;  ///< how many of the list at 5 %
  std::size_t none_step = 1;
  std::size_t pairs = 40;  ///< how far into the list of pairs
  std::size_t pairs_step = 1;
  std::size_t fewest_right = 0;   ///< of the singles
  std::size_t most_alarms = 200;  ///< of those with no effect
};

constexpr Selection kWhole;
// A step of ten meets every other kind only; eleven meets them all.  495 of the whole 504 were
// right and one of 200 an alarm on 2026-11-22; 2 in 46 may be the wrong ones of the whole, 3 aren't
// (p = 0.05).
constexpr Selection kTenth{11, 0, 10, 40, 10, 44, 1};
// Steps of 61 meet nine kinds, both strengths and both noise levels.  With the whole's rate of
// wrong ones, 1.8 %, one sample of nine in a hundred holds two wrong ones.
constexpr Selection kShort{61, 0, 100, 0, 1, 8, 0};

int run(const Selection& selection) {
  auto one = cases_of(kSingles, 504, selection.singles_step);
  auto five_percent = cases_of(kWeak, selection.weak, 1);
  auto nothing = cases_of(kNone, 200, selection.none_step);
  auto two = cases_of(kPairs, selection.pairs, selection.pairs_step);
  // Each list is printed as soon as it is done: the whole takes 75 minutes of processor time.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  ask_all(one, "one effect");
  print_singles("one effect", one);
  ask_all(five_percent, "at 5 %");
  if (!five_percent.empty()) print_singles("one effect at 5 %", five_percent);
  ask_all(nothing, "none");
  std::printf("none: %zu false alarms of %zu (%.1f %%)\n", alarms(nothing), nothing.size(),
              percent(alarms(nothing), nothing.size()));
  ask_all(two, "two effects");
  if (!two.empty()) print_pairs(two);
  std::printf("\n");
  print_matrix(one);
  print_matrix(nothing);
  std::printf("\n");
  for (const auto* cases : {&one, &five_percent, &nothing}) print_misses(*cases);
  if (selection.fewest_right == 0) return 0;
  const bool failed =
      std::ranges::any_of(one, [](const Case& each) { return !each.failure.empty(); });
  const bool good = tally(one).right >= selection.fewest_right &&
                    alarms(nothing) <= selection.most_alarms && !failed;
  if (!good) std::printf("too many are wrong\n");
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  command_line::Program app{
      "Confusion matrix of the residual engine over recordings with planted effects"};
  bool tenth = false;
  bool few = false;
  std::vector<std::size_t> only;
  app.add_flag("--tenth", tenth, "every tenth recording; exit 1 where too many are wrong");
  app.add_flag("--short", few, "nine recordings with an effect and two without; exit 1 likewise");
  app.add_option("--only", only,
                 "LIST INDEX: one recording with everything that was tried; list 1 has one effect "
                 "each, 2 none, 3 two, 4 one at 5 %")
      .expected(2, 2);
  if (const auto status = app.parse(argc, argv)) return *status;
  if (only.empty()) return run(few ? kShort : tenth ? kTenth : kWhole);
  print_one(only[0], only[1]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "planted_effects: %s\n", error.what());
  return 2;
}
