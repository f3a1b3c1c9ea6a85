// SPDX-License-Identifier: Apache-2.0
// power_curves: how large an effect has to be for the residual engine to find it.
// Plants effects of any size under five noises, none of them drawn again, and writes a row for each
// recording: what was planted, how large it is next to the noise, what the engine says.
//   build/tests/power_curves --out rows.csv --count 8 --none 400 --seed 1
// power_curves.py runs it and fits the curves.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <string>
#include <vector>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/system/command_line/command_line.hpp"
#include "tests/benchmark/on_all_cores.hpp"
#include "tests/planted/draw.hpp"
#include "tests/planted/series.hpp"
#include "tests/planted/to_measurement.hpp"

namespace {

using namespace stillhand;

constexpr std::uint64_t kSizeStream = 0x706f776572;
// Drawn: what the effect adds over the force, and the force over the noise.
constexpr double kLeastStrength = 0.005;
constexpr double kLargestStrength = 0.4;
constexpr double kLeastNoise_db = 10.0;
constexpr double kMostNoise_db = 30.0;

struct Case {
  std::uint64_t seed = 0;
  std::string noise;
  planted::Spec spec;
};

std::vector<Case> cases_of(std::size_t count, std::size_t none, std::uint64_t seed) {
  std::vector<Case> cases;
  std::uint64_t of_noise = 0;
  for (const std::string_view noise : planted::kNoiseNames) {
    planted::SeriesPlan plan;
    plan.seed = planted::kNoiseNames.size() * seed + of_noise++;
    plan.kinds.assign(planted::kKindNames.begin(), planted::kKindNames.end());
    plan.noise = noise;
    plan.least_evidence = 0.0;
    const std::size_t with = count * plan.kinds.size();
    for (std::size_t i = 0; i < with + none; ++i) {
      if (i == with) plan.kinds = {"none"};
      auto [own_seed, spec] = plan.at(i);
      planted::Draw draw(own_seed, kSizeStream);
      spec.strengths = {draw.log_uniform(kLeastStrength, kLargestStrength)};
      spec.snr_db = draw.uniform(kLeastNoise_db, kMostNoise_db);
      cases.push_back({own_seed, plan.noise, spec});
    }
  }
  // All kinds and noises from the start: a run that is ended early has some of each.
  std::ranges::stable_sort(cases, {}, [](const Case& each) { return each.seed % 1'000'003u; });
  return cases;
}

bool channel_is_right(const planted::PlantedEffect& effect, const diagnosis::FoundEffect& found) {
  const auto holds = [&](const std::vector<std::string>& names) {
    return std::ranges::find(names, found.channel) != names.end();
  };
  // These move all inputs together, and the verdict names no channel for them.
  const bool in_time =
      effect.kind == planted::Kind::kDelay || effect.kind == planted::Kind::kClockDrift;
  return in_time || effect.channels.empty() || holds(effect.channels) || holds(effect.also);
}

// As far as the linear model cannot imitate it.
double half_of(const diagnosis::Diagnosis& verdict, const std::string& kind) {
  const auto limit = std::ranges::find(verdict.limits, kind, &diagnosis::PlantedLimit::kind);
  return limit == verdict.limits.end() ? 0.0 : limit->half * limit->beyond_linear;
}

std::string row_of(const Case& each) {
  const planted::Draft draft = planted::draw(each.seed, each.spec);
  const planted::Truth& truth = draft.truth;
  const auto begin = std::chrono::steady_clock::now();
  const auto verdict = diagnosis::diagnose(planted::to_measurement(draft.recording), {});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::string found;
  for (const auto& effect : verdict.effects) {
    found += (found.empty() ? "" : "+") + effect.effect.kind;
  }
  const bool none = truth.effects.empty();
  const std::string kind(none ? "none" : planted::name_of(truth.effects.front().kind));
  const double samples = static_cast<double>(draft.recording.time_s.size());
  const bool right =
      none ? verdict.effects.empty()
           : found == kind && channel_is_right(truth.effects.front(), verdict.effects.front());
  char row[512];
  std::snprintf(row, sizeof row, "%llu,%s,%s,%.5g,%.5g,%.5g,%s,%d,%.5g,%.5g,%.3f\n",
                static_cast<unsigned long long>(each.seed), each.noise.c_str(), kind.c_str(),
                truth.strength, truth.noise_rms_n / truth.force_rms_n,
                std::sqrt(truth.evidence / samples), found.c_str(), right ? 1 : 0,
                verdict.detection_limit / truth.noise_rms_n,
                half_of(verdict, kind) / truth.noise_rms_n, took.count());
  return row;
}

void write_all(const std::vector<Case>& cases, std::FILE* file) {
  std::mutex writing;
  std::size_t done = 0;
  benchmark::on_all_cores(cases.size(), [&](std::size_t i) {
    const std::string row = row_of(cases[i]);
    const std::lock_guard lock(writing);
    std::fputs(row.c_str(), file);
    std::fflush(file);
    std::fprintf(stderr, "\r%zu of %zu   ", ++done, cases.size());
  });
  std::fputc('\n', stderr);
}

}  // namespace

int main(int argc, char** argv) try {
  command_line::Program app{
      "Effects of any size under five noises, and what the residual engine says of them"};
  std::string out;
  std::size_t count = 8;
  std::size_t none = 400;
  std::uint64_t seed = 1;
  app.add_option("--out", out, "CSV file, a row for each recording").required();
  app.add_option("--count", count, "recordings of each kind under each noise")
      .capture_default_str();
  app.add_option("--none", none, "recordings without an effect under each noise")
      .capture_default_str();
  app.add_option("--seed", seed, "of all of them").capture_default_str();
  if (const auto status = app.parse(argc, argv)) return *status;
  std::FILE* file = std::fopen(out.c_str(), "w");
  if (file == nullptr) {
    std::fprintf(stderr, "power_curves: %s: cannot be written\n", out.c_str());
    return 2;
  }
  std::fputs(
      "seed,noise,kind,strength,noise_over_force,size_over_noise,found,right,limit_over_noise,"
      "half_over_noise,seconds\n",
      file);
  write_all(cases_of(count, none, seed), file);
  std::fclose(file);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "power_curves: %s\n", error.what());
  return 2;
}
