// SPDX-License-Identifier: Apache-2.0
// Ties of planted effects, and what breaks them: the run that plan-run designs, against a
// repetition of the recorded motion.
//   build/tests/broken_ties --ties 10 --seed 1
//   build/tests/broken_ties --rig --seed 7001 --cell-noise 0.1
// A recording is diagnosed; where the planted kind ties with another one, a run of --seconds is
// designed, made on the same body with other noise, and judged; then a run of --repeat-seconds in a
// motion like the first one.  "right": the planted kind alone is left; "wrong": another one is.
#include <algorithm>
#include <cstdio>
#include <set>
#include <string>

#include "apps/libraries/session/protocol.hpp"
#include "services/core/diagnosis/working_set.hpp"
#include "services/core/next_run/design.hpp"
#include "services/core/next_run/tie.hpp"
#include "services/system/command_line/command_line.hpp"
#include "tests/benchmark/on_all_cores.hpp"
#include "tests/benchmark/tied_subject.hpp"
#include "tests/planted/series.hpp"

namespace {

using namespace stillhand;

struct Options {
  std::size_t ties = 10;
  std::uint64_t seed = 1;
  double seconds = 30.0;
  double repeat_seconds = 120.0;
  double strength = 0.1;
  double snr_db = 20.0;
  std::size_t most = 200;
  std::vector<std::size_t> only;
  bool on_rig = false;
  benchmark::TiedRig rig;
};

struct Counts {
  int right = 0, wrong = 0, open = 0;
};

diagnosis::Measurement at_rate(const diagnosis::Measurement& run, double rate_hz) {
  const std::size_t factor = diagnosis::rate_factor(run, rate_hz);
  return factor == 1 ? run : diagnosis::decimated(run, factor);
}

std::string outcome(const next_run::Contest& contest, const next_run::Evidence& evidence,
                    const std::string& kind, Counts& counts) {
  const Eigen::Index winner = evidence.winner();
  std::string left;
  for (const Eigen::Index i : evidence.left()) {
    left +=
        (left.empty() ? "" : ",") + contest.candidates()[static_cast<std::size_t>(i)].cause().kind;
  }
  const bool right =
      winner >= 0 && contest.candidates()[static_cast<std::size_t>(winner)].cause().kind == kind;
  ++(winner < 0 ? counts.open : right ? counts.right : counts.wrong);
  return (winner < 0 ? "open: " : right ? "right: " : "WRONG: ") + left;
}

next_run::Bounds bounds_of(double seconds) {
  session::ProtocolOptions protocol;
  protocol.identify_s = seconds;
  protocol.planned = true;
  return {session::motion_profile(session::identification_trial(protocol)), {}};
}

planted::SeriesPlan series_of(const Options& options) {
  planted::SeriesPlan plan;
  plan.seed = options.seed;
  plan.strengths = {options.strength};
  plan.snrs_db = {options.snr_db};
  plan.kinds = {"time_varying_gain",
                "nonlinear_stiffness",
                "coulomb_friction",
                "hysteresis",
                "resonance",
                "coupled_input",
                "delay",
                "drift",
                "dead_zone",
                "asymmetry",
                "output_saturation",
                "bilinear"};
  return plan;
}

// The i-th of the series.
benchmark::TiedSubject subject_of(const Options& options, std::size_t i) {
  if (options.on_rig) return benchmark::rig_subject(options.seed + i, options.rig);
  const auto [seed, spec] = series_of(options).at(i);
  return benchmark::planted_subject(seed, spec);
}

int run(const Options& options) {
  Counts designed, repeated;
  std::set<std::set<std::string>> seen;
  std::size_t ties = 0;
  double expected = 0.0;
  for (std::size_t i = 0; i < options.most && ties < options.ties; ++i) {
    if (!options.only.empty() && std::ranges::find(options.only, i) == options.only.end()) continue;
    const benchmark::TiedSubject subject = subject_of(options, i);
    const std::string& kind = subject.kind;
    diagnosis::DiagnoseOptions asked;
    asked.for_each = benchmark::on_all_cores;
    const auto verdict = diagnosis::diagnose(subject.measured, asked);
    const auto working = diagnosis::working_set(subject.measured, asked.inputs);
    const diagnosis::Signals signals(working, asked.inputs, asked.output);
    const auto closes = next_run::ties_of(verdict, signals);
    const next_run::Tie tie = closes.empty() ? next_run::Tie{} : closes.front();
    std::set<std::string> kinds;
    for (const auto& each : tie.close) kinds.insert(each.cause().kind);
    if (!kinds.contains(kind) || kinds.size() < 2) {
      std::fprintf(stderr, "%zu %s: %s;", i, kind.c_str(), verdict.verdict().c_str());
      for (const auto& each : verdict.effects)
        std::fprintf(stderr, " %s", each.effect.kind.c_str());
      std::fprintf(stderr, "; %zu candidates\n", tie.close.size());
      continue;
    }
    // The planted kind and another one must be left; a set of kinds counts once.
    std::set<std::string> left;
    for (const auto& each : tie.left) left.insert(each.cause().kind);
    std::fprintf(stderr, "%zu %s: of", i, kind.c_str());
    for (const std::string& each : kinds) std::fprintf(stderr, " %s", each.c_str());
    std::fprintf(stderr, " left");
    for (const std::string& each : left) std::fprintf(stderr, " %s", each.c_str());
    std::fprintf(stderr, "%s\n", left.contains(kind) ? "" : ", not the planted one");
    if (!left.contains(kind) || left.size() < 2 || !seen.insert(left).second) continue;
    const next_run::Contest contest(tie.left, signals);
    ++ties;
    const auto best =
        next_run::best_plan(contest, working, bounds_of(options.seconds), benchmark::on_all_cores);
    const double rate_hz = contest.candidates().front().model.rate_hz;
    const auto after = contest.with(at_rate(subject.again(best.ride.motion), rate_hz));
    const auto again = contest.with(at_rate(subject.repeated(options.repeat_seconds), rate_hz));
    expected += best.probability_settled;
    std::printf("%2zu  %-20s (%s)\n    tied:", ties, kind.c_str(), subject.variant.c_str());
    for (const auto& each : contest.candidates()) {
      std::printf(" %s;", next_run::name_of(each).c_str());
    }
    std::printf("\n    %s %.2f-%.2f Hz level %.2f quiet %.2f, P settled %.2f, repeated %.2f\n",
                next_run::in_words(best.design.family).c_str(), best.design.low_hz,
                best.design.high_hz, best.design.level, best.design.quiet, best.probability_settled,
                best.probability_repeated);
    std::printf("    evidence for the first, before: ");
    for (Eigen::Index j = 1; j < best.expected.separation.rows(); ++j) {
      std::printf(" %.1f +- %.1f", contest.before().twice_log_ratio(0, j),
                  contest.before().standard_error(0, j));
    }
    std::printf("; separation");
    for (Eigen::Index j = 1; j < best.expected.separation.rows(); ++j) {
      std::printf(" %.1f/%.1f", best.expected.separation(0, j), best.expected.separation(j, 0));
    }
    std::printf("; after");
    for (Eigen::Index j = 1; j < best.expected.separation.rows(); ++j) {
      std::printf(" %.1f +- %.1f", after.twice_log_ratio(0, j), after.standard_error(0, j));
    }
    std::printf("\n");
    std::printf("    designed %.0f s  %s\n", options.seconds,
                outcome(contest, after, kind, designed).c_str());
    std::printf("    repeated %.0f s  %s\n", options.repeat_seconds,
                outcome(contest, again, kind, repeated).c_str());
    std::fflush(stdout);
  }
  std::printf(
      "%zu ties; designed: %d right, %d wrong, %d open (expected %.1f settled); repeated: "
      "%d right, %d wrong, %d open\n",
      ties, designed.right, designed.wrong, designed.open, expected, repeated.right, repeated.wrong,
      repeated.open);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Program app{"Ties of planted effects, and what breaks them"};
  Options options;
  app.add_option("--ties", options.ties, "how many");
  app.add_option("--seed", options.seed, "of the series of recordings");
  app.add_option("--seconds", options.seconds, "of the designed run");
  app.add_option("--repeat-seconds", options.repeat_seconds, "of the repetition");
  app.add_option("--strength", options.strength, "of the effects, of the force");
  app.add_option("--snr", options.snr_db, "of the force over the noise [dB]");
  app.add_option("--most", options.most, "recordings that are tried");
  app.add_option("--only", options.only, "numbers of the recordings that are tried");
  app.add_flag("--rig", options.on_rig, "the simulated rig and its undeclared effects");
  app.add_option("--first-seconds", options.rig.seconds, "--rig: of the first recording");
  app.add_option("--cell-noise", options.rig.noise_n_rthz, "--rig: of the load cell [N/sqrt(Hz)]");
  app.add_flag("--passive", options.rig.passive, "--rig: an arm without forces of its own");
  if (const auto status = app.parse(argc, argv)) return *status;
  return run(options);
}
