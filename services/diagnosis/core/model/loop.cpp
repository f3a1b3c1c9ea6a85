// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/model/loop.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/contract/expects.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/diagnosis/core/model/evaluation.hpp"

namespace stillhand::diagnosis {
namespace {

// q^-1 sum c_i D^i by powers of q^-1.
std::vector<double> late(std::span<const double> coefficients) {
  std::vector<double> powers = difference_basis({coefficients.begin(), coefficients.end()});
  powers.insert(powers.begin(), 0.0);
  return powers;
}

// A signal of a stretch behind as many zeros as the body looks back.
using Padded = std::vector<double>;

struct Running {
  Nonlinearity nonlinearity;
  LoopPath path;
  double low = -HUGE_VAL;  // phi is held beyond
  double high = HUGE_VAL;
  LoopMemory memory{};
  Padded z{};
  Padded phi{};

  double phi_of(double at) {
    return nonlinearity.phi(std::clamp(at, low, high) / nonlinearity.threshold, memory);
  }
};

// sum_{i = from..P} taps_i newest_{-i}
template <std::size_t P>
double past_sum(const double* taps, std::size_t from, std::size_t order, const double* newest) {
  double sum = 0.0;
  for (std::size_t i = from; i <= (P == 0 ? order : P); ++i) {
    sum += taps[i] * newest[-static_cast<std::ptrdiff_t>(i)];
  }
  return sum;
}

struct StretchRun {
  std::vector<Running> loops;
  std::vector<Padded> inputs;
  Padded output;
};

// For a body of order P; 0: of any.  The fit spends most of its time here.
template <std::size_t P>
bool run_stretch(const Body& body, double runaway, StretchRun& run) {
  const std::size_t order = body.order();
  const double* a = body.denominator.data();
  for (std::size_t n = order; n < run.output.size(); ++n) {
    double y = -past_sum<P>(a, 1, order, &run.output[n]);
    for (std::size_t k = 0; k < run.inputs.size(); ++k) {
      y += past_sum<P>(body.numerators[k].data(), 0, order, &run.inputs[k][n]);
    }
    for (const Running& loop : run.loops) {
      y += past_sum<P>(loop.path.e.data(), 1, order, &loop.phi[n]);
    }
    for (Running& loop : run.loops) {
      if (loop.path.of_output()) {
        loop.z[n] = y;
      } else {
        loop.z[n] = past_sum<P>(loop.path.n.data(), 0, order, &run.inputs[0][n]) +
                    past_sum<P>(loop.path.m.data(), 1, order, &loop.phi[n]) -
                    past_sum<P>(a, 1, order, &loop.z[n]);
      }
      loop.phi[n] = loop.phi_of(loop.z[n]);
      y += loop.path.e[0] * loop.phi[n];
    }
    run.output[n] = y;
    if (!(std::abs(y) < runaway)) return false;
  }
  return true;
}

bool run_stretch_of_order(const Body& body, double runaway, StretchRun& run) {
  switch (body.order()) {
    case 2:
      return run_stretch<2>(body, runaway, run);
    case 3:
      return run_stretch<3>(body, runaway, run);
    case 4:
      return run_stretch<4>(body, runaway, run);
    case 6:
      return run_stretch<6>(body, runaway, run);
    default:
      return run_stretch<0>(body, runaway, run);
  }
}

double sum_of(const std::vector<double>& c) { return std::accumulate(c.begin(), c.end(), 0.0); }

// What everything holds before a stretch, under the inputs' levels.
struct Rest {
  double output = 0.0;
  std::vector<double> z;
  std::vector<double> phi;
};

double phi_afresh(Running& loop, double z) {
  loop.memory = {};
  return loop.phi_of(z);
}

// z = c + g phi(z) by Newton's steps from c, each halved until it helps.  The best that was found
// where there is none.
double equilibrium(Running& loop, double c, double g) {
  constexpr int kMostSteps = 50;
  constexpr int kMostHalvings = 20;
  const auto miss = [&](double z) { return z - c - g * phi_afresh(loop, z); };
  double z = c;
  double error = miss(z);
  for (int step = 0; step < kMostSteps && error != 0.0; ++step) {
    const double near = 1e-6 * std::max(std::abs(z), loop.nonlinearity.threshold);
    const double slope = (miss(z + near) - error) / near;
    double move = slope != 0.0 ? -error / slope : -error;
    double next = miss(z + move);
    for (int i = 0; i < kMostHalvings && !(std::abs(next) < std::abs(error)); ++i) {
      move *= 0.5;
      next = miss(z + move);
    }
    if (!(std::abs(next) < std::abs(error))) break;
    z += move;
    error = next;
  }
  return std::isfinite(error) ? z : 0.0;
}

Rest rest_of(const Body& body, std::vector<Running>& loops, const std::vector<double>& levels) {
  constexpr int kSweeps = 20;  // one loop settles in the first
  const double a = sum_of(body.denominator);
  double linear = 0.0;
  for (std::size_t k = 0; k < levels.size(); ++k) linear += sum_of(body.numerators[k]) * levels[k];
  Rest rest{linear / a, std::vector<double>(loops.size(), 0.0),
            std::vector<double>(loops.size(), 0.0)};
  for (int sweep = 0; sweep < (loops.size() > 1 ? kSweeps : 1); ++sweep) {
    for (std::size_t i = 0; i < loops.size(); ++i) {
      const LoopPath& path = loops[i].path;
      const double e = sum_of(path.e) / a;
      rest.output -= e * rest.phi[i];
      rest.z[i] = path.of_output()
                      ? equilibrium(loops[i], rest.output, e)
                      : equilibrium(loops[i], sum_of(path.n) * levels[0] / a, sum_of(path.m) / a);
      rest.phi[i] = phi_afresh(loops[i], rest.z[i]);
      rest.output += e * rest.phi[i];
    }
  }
  return rest;
}

}  // namespace

std::size_t loop_coefficients(bool of_output, std::size_t order) noexcept {
  return of_output ? order : 3 * order + 2;
}

LoopPath loop_path(const Effect& effect, std::size_t order) {
  const bool of_output = effect.coefficients.size() == loop_coefficients(true, order);
  STILLHAND_EXPECTS(of_output || effect.coefficients.size() == loop_coefficients(false, order));
  const std::span<const double> all(effect.coefficients);
  LoopPath path;
  if (of_output) {
    path.e = late(all);
    return path;
  }
  const auto powers = [](std::span<const double> part) {
    return difference_basis({part.begin(), part.end()});
  };
  path.e = powers(all.first(order + 1));
  path.n = powers(all.subspan(order + 1, order + 1));
  path.m = late(all.last(order));
  return path;
}

bool run_loop(const Body& body, const std::vector<const Effect*>& feedback,
              const std::vector<Settled>& inputs, const Signals& signals, LoopRun& run) {
  const double runaway = runaway_bound(signals.output());
  const std::size_t order = body.order();
  StretchRun of_stretch;
  of_stretch.inputs.resize(inputs.size());
  for (const Effect* effect : feedback) {
    Running loop{effect_kind(effect->kind).feedback(*effect), loop_path(*effect, order)};
    if (!effect->seen.empty()) {
      loop.low = effect->seen.front().lower_edge();
      loop.high = effect->seen.front().upper_edge();
    }
    of_stretch.loops.push_back(std::move(loop));
  }
  for (auto* each : {&run.output, &run.argument, &run.phi}) each->assign(signals.size(), 0.0);
  run.output_before.clear();
  run.phi_before.clear();
  return std::ranges::all_of(signals.stretches(), [&](const Stretch& stretch) {
    std::vector<double> levels;
    levels.reserve(inputs.size());
    for (const Settled& input : inputs) levels.push_back(input.before[run.output_before.size()]);
    const Rest rest = rest_of(body, of_stretch.loops, levels);
    run.output_before.push_back(rest.output);
    run.phi_before.push_back(rest.phi.front());
    const auto first = static_cast<std::ptrdiff_t>(stretch.first);
    const std::size_t count = stretch.end - stretch.first;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      Padded& padded = of_stretch.inputs[k];
      const std::vector<double>& u = inputs[k].values;
      padded.assign(order, levels[k]);
      padded.insert(padded.end(), u.begin() + first,
                    u.begin() + static_cast<std::ptrdiff_t>(stretch.end));
    }
    of_stretch.output.assign(order + count, rest.output);
    for (std::size_t i = 0; i < of_stretch.loops.size(); ++i) {
      Running& loop = of_stretch.loops[i];
      loop.memory = {};
      loop.z.assign(order + count, rest.z[i]);
      loop.phi.assign(order + count, rest.phi[i]);
    }
    const bool bounded = run_stretch_of_order(body, runaway, of_stretch);
    const auto back = [&](const Padded& from, std::vector<double>& to) {
      std::copy(from.begin() + static_cast<std::ptrdiff_t>(order), from.end(), to.begin() + first);
    };
    back(of_stretch.output, run.output);
    back(of_stretch.loops.front().z, run.argument);
    back(of_stretch.loops.front().phi, run.phi);
    return bounded;
  });
}

}  // namespace stillhand::diagnosis
