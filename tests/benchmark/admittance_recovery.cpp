// SPDX-License-Identifier: Apache-2.0
// How well admittance, feedthrough and the physical arm are recovered from the simulated rig, and
// what a pegged identification costs.  RESULTS, "Admittance and feedthrough".
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "services/core/admittance/arm_fit.hpp"
#include "services/core/admittance/relation.hpp"
#include "services/core/population/population.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/signal/spectrum.hpp"
#include "tests/benchmark/on_all_cores.hpp"
#include "tests/support/rig_record.hpp"

namespace stillhand {
namespace {

using admittance::ArmFit;
using admittance::ArmValues;
using Complex = std::complex<double>;

enum class Task { kHold, kRelax, kGiveWay };
constexpr std::array kTasks{Task::kHold, Task::kRelax, Task::kGiveWay};
constexpr std::array kTaskNames{"hold position", "relax", "give way"};
enum class Variant { kStructure, kPerson };
constexpr std::array kVariants{Variant::kStructure, Variant::kPerson};
constexpr std::array kVariantNames{"structure of the model, involuntary force",
                                   "stiffness wanders, unmeasured motion, friction, half a tick"};

constexpr double kUnseenPeriod_s = 20.0;
constexpr double kUnseenLow_hz = 0.7;
constexpr double kUnseenHigh_hz = 2.0;
constexpr double kUnseen_m_s2 = 1.6;

// RESULTS: the setting of a task is a choice of ours.
rig::RigConfig rig_of(std::int64_t arm, Task task, Variant variant) {
  rig::RigConfig rig;
  rig.seed = 1000 + 10 * arm + static_cast<std::int64_t>(task);
  rig.body = population::draw_subject({}, 20261125, arm).body;
  auto& nerves = rig.body.neuromuscular;
  if (variant == Variant::kStructure) {
    nerves.wander = 0.0;
    nerves.unmeasured_force_n_s2_m = 0.0;
    rig.stick.coulomb_friction_n = 0.0;
  }
  if (task == Task::kHold) {
    signal::Gaussian draw(7, static_cast<std::uint64_t>(arm));
    nerves.reflex_stiffness_n_m = 100.0 + 300.0 * draw.uniform();
    nerves.reflex_damping_n_s_m = 0.125 * nerves.reflex_stiffness_n_m;
    nerves.reflex_delay_s = 0.025 + 0.015 * draw.uniform();
    return rig;
  }
  rig.body.cocontraction_stiffness_factor = 1.0;
  rig.body.cocontraction_damping_factor = 1.0;
  if (task == Task::kGiveWay) {
    rig.body.shoulder_stiffness_n_m *= 0.5;
    rig.body.shoulder_damping_n_s_m *= std::sqrt(0.5);
  }
  return rig;
}

// The same muscles on the peg, where the rig takes the idle hand's: its values become the task's.
rig::RigConfig kept_on_peg(rig::RigConfig rig) {
  rig.body.shoulder_stiffness_n_m *= rig.body.cocontraction_stiffness_factor;
  rig.body.grip_stiffness_n_m *= rig.body.cocontraction_stiffness_factor;
  rig.body.shoulder_damping_n_s_m *= rig.body.cocontraction_damping_factor;
  rig.body.grip_damping_n_s_m *= rig.body.cocontraction_damping_factor;
  rig.body.cocontraction_stiffness_factor = rig.body.cocontraction_damping_factor = 1.0;
  return rig;
}

struct Designs {
  admittance::Excitation straight, swapped;            // at 1 kHz
  admittance::Excitation read_straight, read_swapped;  // at the records' rate
  signal::Multisine unseen;
};

signal::Multisine unseen_motion() {
  signal::Gaussian draw(99, 1);
  const auto first = static_cast<std::int64_t>(std::lround(kUnseenLow_hz * kUnseenPeriod_s));
  const auto last = static_cast<std::int64_t>(std::lround(kUnseenHigh_hz * kUnseenPeriod_s));
  std::vector<signal::Component> lines;
  for (std::int64_t k = first; k <= last; ++k) {
    lines.push_back({k, kUnseen_m_s2 * std::sqrt(2.0 / static_cast<double>(last - first + 1)),
                     2.0 * std::numbers::pi * draw.uniform()});
  }
  return {std::llround(1000.0 * kUnseenPeriod_s), 1000.0, lines};
}

Designs designs() {
  const auto at = [](double rate_hz, bool swapped) {
    return admittance::design({.rate_hz = rate_hz, .swapped = swapped});
  };
  return {at(1000.0, false), at(1000.0, true), at(250.0, false), at(250.0, true), unseen_motion()};
}

// Share of `output` over the unseen motion that G(f) A does not explain, in the moved band.
double unexplained(const std::vector<double>& output, const std::vector<double>& acceleration,
                   const std::function<Complex(double)>& response) {
  double error = 0.0;
  double all = 0.0;
  const auto first = static_cast<std::int64_t>(std::lround(kUnseenLow_hz * kUnseenPeriod_s));
  const auto last = static_cast<std::int64_t>(std::lround(kUnseenHigh_hz * kUnseenPeriod_s));
  for (std::int64_t k = first; k <= last; ++k) {
    const Complex y = signal::line_at(output, k);
    const double f = static_cast<double>(k) / kUnseenPeriod_s;
    error += std::norm(y - response(f) * signal::line_at(acceleration, k));
    all += std::norm(y);
  }
  return std::sqrt(error / all);
}

enum Predictor { kMeanCompliance, kPeggedModel, kBoth, kTrueArm, kPredictors };
constexpr std::array kPredictorNames{
    "pegged feedthrough, mean person's compliance", "pegged feedthrough, arm fitted to it",
    "admittance and feedthrough, arm fitted to both", "the true arm (floor)"};
struct Outcome {
  admittance::LineEstimates lines;
  ArmFit fit;
  ArmValues truth{}, bound{};
  bool same_reflex = false;
  admittance::RelationTest kept, idle;
  std::array<double, kPredictors> position{}, force{};
};

Outcome outcome_of(const Designs& d, std::int64_t arm, Task task, Variant variant) {
  const rig::RigConfig rig = rig_of(arm, task, variant);
  const rig::RigConfig idle = rig_of(arm, Task::kRelax, variant);
  Outcome out;
  out.truth = simulated::arm_of(rig, false);
  simulated::RigRun run{.rig = rig, .motion = &d.straight.motion, .force = &d.straight.force};
  run.mean_of_tick = variant == Variant::kStructure;
  out.lines = admittance::estimate(simulated::record(run).record, d.read_straight);
  out.fit = admittance::fit_arm(out.lines);
  out.same_reflex = out.fit.reflex == (task == Task::kHold);
  out.bound = admittance::least_standard_errors(out.lines, out.truth, task == Task::kHold);
  run.motion = &d.swapped.motion;
  run.force = &d.swapped.force;
  run.rig.seed += 4;
  const auto swapped = admittance::estimate(simulated::record(run).record, d.read_swapped);
  const auto pegged = [&](const rig::RigConfig& config) {
    const simulated::RigRun on_peg{.rig = config, .motion = &d.straight.motion, .pegged = true};
    return admittance::estimate_pegged(simulated::record(on_peg).record, d.read_straight);
  };
  const auto idle_lines = pegged(idle);
  const auto relation = [&](const std::vector<admittance::LineResponse>& held) {
    return admittance::test_relation(out.lines.feedthrough_to_position, held,
                                     swapped.stick_per_force, out.lines.neighbours);
  };
  out.idle = relation(idle_lines);
  out.kept = relation(pegged(kept_on_peg(rig)));

  run = {.rig = rig, .motion = &d.unseen, .periods = 1};
  run.rig.seed += 5;
  const simulated::RigRecord unseen = simulated::record(run);
  const admittance::StickValues stick = simulated::stick_of(rig.stick);
  const ArmValues by_peg = admittance::fit_pegged_arm(idle_lines, out.lines.neighbours).values;
  const std::array<std::pair<ArmValues, ArmValues>, kPredictors> feedthrough_and_impedance{
      {{by_peg, admittance::mean_arm()},
       {by_peg, by_peg},
       {out.fit.values, out.fit.values},
       {out.truth, out.truth}}};
  for (std::size_t i = 0; i < kPredictors; ++i) {
    const auto& [of_feedthrough, of_impedance] = feedthrough_and_impedance[i];
    const auto arm_at = [&](double f) {
      admittance::ArmResponse at = admittance::arm_response(of_impedance, f);
      at.feedthrough = admittance::arm_response(of_feedthrough, f).feedthrough;
      return at;
    };
    const auto& a = unseen.record.acceleration_m_s2;
    out.position[i] = unexplained(unseen.record.displacement_m, a, [&](double f) {
      return admittance::free_stick(arm_at(f), stick, f).feedthrough_to_position;
    });
    out.force[i] =
        unexplained(unseen.held_force_n, a, [&](double f) { return arm_at(f).feedthrough; });
  }
  return out;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return NAN;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}
double median(const std::vector<double>& values) { return quantile(values, 0.5); }

struct Band {
  double low_hz, high_hz;
};
constexpr std::array kBands{Band{0.0, 0.5}, Band{0.5, 5.0}, Band{5.0, 25.0}};

using Lines = std::vector<admittance::LineResponse> admittance::LineEstimates::*;

// Median over the lines of a band: bias, spread, bound in %.
void print_lines(const std::vector<Outcome>& all, const char* name, Lines which,
                 const std::function<Complex(const ArmValues&, double)>& truth_at) {
  std::printf("| %s ", name);
  for (const Band& band : kBands) {
    std::vector<double> biases;
    std::vector<double> spreads;
    std::vector<double> bounds;
    for (std::size_t k = 0; k < (all[0].lines.*which).size(); ++k) {
      const double f = (all[0].lines.*which)[k].frequency_hz;
      if (f < band.low_hz || f >= band.high_hz) continue;
      Complex mean = 0.0;
      double square = 0.0;
      double bound = 0.0;
      const auto count = static_cast<double>(all.size());
      for (const Outcome& one : all) {
        const auto& line = (one.lines.*which)[k];
        const Complex truth = truth_at(one.truth, f);
        const Complex error = line.response / truth - 1.0;
        mean += error / count;
        square += std::norm(error) / count;
        bound += line.variance / std::norm(truth) / count;
      }
      biases.push_back(std::abs(mean));
      spreads.push_back(std::sqrt(std::max(0.0, square - std::norm(mean))));
      bounds.push_back(std::sqrt(bound));
    }
    std::printf("| %.1f, %.1f, %.1f ", 100.0 * median(biases), 100.0 * median(spreads),
                100.0 * median(bounds));
  }
  std::printf("|\n");
}

void print_responses(const std::vector<Outcome>& all) {
  std::printf(
      "\nBias, spread, Cramer-Rao bound [%%], median over the lines of a band\n\n"
      "| response | 0.05-0.5 Hz | 0.5-5 Hz | 5-20 Hz |\n| --- | --- | --- | --- |\n");
  using admittance::arm_response;
  using admittance::free_stick;
  print_lines(all, "admittance", &admittance::LineEstimates::admittance,
              [](const ArmValues& arm, double f) { return 1.0 / arm_response(arm, f).impedance; });
  print_lines(all, "feedthrough to force", &admittance::LineEstimates::feedthrough_to_force,
              [](const ArmValues& arm, double f) {
                return free_stick(arm_response(arm, f), {}, f).feedthrough_to_force;
              });
  print_lines(all, "feedthrough to position", &admittance::LineEstimates::feedthrough_to_position,
              [](const ArmValues& arm, double f) {
                return free_stick(arm_response(arm, f), {}, f).feedthrough_to_position;
              });
}

void print_parameters(const std::vector<Outcome>& all, Task task) {
  std::printf(
      "\n| parameter | bias [%%] | spread [%%] | bound [%%] | within 2 errors [%%] | undetermined "
      "[%%] |\n| --- | --- | --- | --- | --- | --- |\n");
  const std::size_t count =
      task == Task::kHold ? admittance::kArmParameters : admittance::kReflexStiffness;
  for (std::size_t p = 0; p < count; ++p) {
    std::vector<double> errors;
    std::vector<double> bounds;
    double within = 0.0;
    double undetermined = 0.0;
    for (const Outcome& one : all) {
      if (!one.same_reflex) continue;
      const double error = one.fit.values[p] - one.truth[p];
      errors.push_back(error / one.truth[p]);
      bounds.push_back(one.bound[p] / one.truth[p]);
      within += std::abs(error) < 2.0 * one.fit.standard_error[p] ? 1.0 : 0.0;
      undetermined += std::ranges::count(one.fit.undetermined, p) > 0 ? 1.0 : 0.0;
    }
    const double middle = median(errors);
    std::vector<double> distances;
    for (const double e : errors) distances.push_back(std::abs(e - middle));
    const double share = 100.0 / static_cast<double>(std::max<std::size_t>(1, errors.size()));
    std::printf("| %s | %.1f | %.1f | %.1f | %.0f | %.0f |\n",
                std::string(admittance::arm_parameter_names()[p].name).c_str(), 100.0 * middle,
                148.26 * median(distances), 100.0 * median(bounds), share * within,
                share * undetermined);
  }
}

std::vector<double> of_all(const std::vector<Outcome>& all,
                           const std::function<double(const Outcome&)>& value) {
  std::vector<double> out;
  for (const Outcome& one : all) out.push_back(value(one));
  return out;
}

void print_rest(const std::vector<Outcome>& all) {
  const auto middle = [&](const std::function<double(const Outcome&)>& value) {
    return median(of_all(all, value));
  };
  double right = 0.0;
  for (const Outcome& one : all) right += one.same_reflex ? 1.0 : 0.0;
  std::printf("\nmisfit %.2f, condition %.0f, reflex found or left out rightly %.0f %%\n",
              middle([](const Outcome& o) { return o.fit.misfit; }),
              middle([](const Outcome& o) { return o.fit.condition; }),
              100.0 * right / static_cast<double>(all.size()));
  for (const auto& [name, of] :
       {std::pair{"task kept on the peg", &Outcome::kept}, {"idle on the peg", &Outcome::idle}}) {
    std::printf("relation, %s: median |M| %.1f %%, radius %.1f %%, lines within %.0f %%\n", name,
                100.0 * middle([&](const Outcome& o) { return (o.*of).median_mismatch; }),
                100.0 * middle([&](const Outcome& o) { return (o.*of).median_radius; }),
                100.0 * middle([&](const Outcome& o) { return (o.*of).share_within; }));
  }
  std::printf(
      "\n| predicted from | stick's motion left [%%], median, 90 %% | held force left [%%], "
      "median, "
      "90 %% |\n| --- | --- | --- |\n");
  for (std::size_t i = 0; i < kPredictors; ++i) {
    const auto x = of_all(all, [&](const Outcome& o) { return o.position[i]; });
    const auto f = of_all(all, [&](const Outcome& o) { return o.force[i]; });
    std::printf("| %s | %.0f, %.0f | %.0f, %.0f |\n", kPredictorNames[i], 100.0 * median(x),
                100.0 * quantile(x, 0.9), 100.0 * median(f), 100.0 * quantile(f, 0.9));
  }
}

}  // namespace
}  // namespace stillhand

int main(int argc, char** argv) {
  using namespace stillhand;
  CLI::App cli("Recovery of admittance, feedthrough and arm from the simulated rig");
  std::size_t arms = 100;
  cli.add_option("--arms", arms, "arms drawn from the population")->check(CLI::Range(2, 1000));
  CLI11_PARSE(cli, argc, argv);
  const Designs all_designs = designs();
  for (const Variant variant : kVariants) {
    for (const Task task : kTasks) {
      std::vector<Outcome> all(arms);
      benchmark::on_all_cores(arms, [&](std::size_t i) {
        all[i] = outcome_of(all_designs, static_cast<std::int64_t>(i), task, variant);
      });
      std::printf("\n## %s; %s\n", kTaskNames[static_cast<std::size_t>(task)],
                  kVariantNames[static_cast<std::size_t>(variant)]);
      print_responses(all);
      print_parameters(all, task);
      print_rest(all);
      std::fflush(stdout);
    }
  }
  return 0;
}
