// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/model/loop.hpp"

#include <algorithm>
#include <cmath>

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
  LoopMemory memory;
  Padded z;
  Padded phi;
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
      loop.phi[n] = loop.nonlinearity.phi(loop.z[n] / loop.nonlinearity.threshold, loop.memory);
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
              const std::vector<std::vector<double>>& inputs, const Signals& signals,
              LoopRun& run) {
  const double runaway = runaway_bound(signals.output());
  const std::size_t order = body.order();
  StretchRun of_stretch;
  of_stretch.inputs.resize(inputs.size());
  for (const Effect* effect : feedback) {
    of_stretch.loops.push_back(
        {effect_kind(effect->kind).feedback(*effect), loop_path(*effect, order), {}, {}, {}});
  }
  for (auto* each : {&run.output, &run.argument, &run.phi}) each->assign(signals.size(), 0.0);
  return std::ranges::all_of(signals.stretches(), [&](const Stretch& stretch) {
    const auto first = static_cast<std::ptrdiff_t>(stretch.first);
    const std::size_t count = stretch.end - stretch.first;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      Padded& padded = of_stretch.inputs[k];
      padded.assign(order, 0.0);
      padded.insert(padded.end(), inputs[k].begin() + first,
                    inputs[k].begin() + static_cast<std::ptrdiff_t>(stretch.end));
    }
    of_stretch.output.assign(order + count, 0.0);
    for (Running& loop : of_stretch.loops) {
      loop.memory = {};
      loop.z.assign(order + count, 0.0);
      loop.phi.assign(order + count, 0.0);
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
