// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/core/loop.hpp"

#include <algorithm>
#include <cmath>

#include "contract/expects.hpp"
#include "diagnosis/core/effect_kind.hpp"

namespace stillhand::diagnosis {
namespace {

// q^-1 sum c_i D^i by powers of q^-1.
std::vector<double> late(std::span<const double> coefficients) {
  std::vector<double> powers = difference_basis({coefficients.begin(), coefficients.end()});
  powers.insert(powers.begin(), 0.0);
  return powers;
}

// One nonlinearity while a stretch runs; newest sample last.
struct Running {
  const Effect* effect;
  const EffectKind* kind;
  LoopPath path;
  LoopMemory memory;
  std::vector<double> z;    // [samples of the stretch]
  std::vector<double> phi;  // [samples of the stretch]
};

double past_sum(const std::vector<double>& taps, std::size_t from, const double* newest,
                std::size_t past) {
  double sum = 0.0;
  const double* tap = taps.data();
  const std::size_t end = std::min(taps.size(), past + 1);
  for (std::size_t i = from; i < end; ++i) sum += tap[i] * *(newest - i);
  return sum;
}

bool run_stretch(const Body& body, std::vector<Running>& loops,
                 const std::vector<std::vector<double>>& inputs, const Stretch& stretch,
                 double runaway, std::vector<double>& output) {
  const std::size_t count = stretch.end - stretch.first;
  for (Running& loop : loops) {
    loop.memory = {};
    loop.z.assign(count, 0.0);
    loop.phi.assign(count, 0.0);
  }
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t at = stretch.first + n;
    double y = -past_sum(body.denominator, 1, &output[at], n);
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      y += past_sum(body.numerators[k], 0, &inputs[k][at], n);
    }
    for (const Running& loop : loops) y += past_sum(loop.path.e, 1, &loop.phi[n], n);
    for (Running& loop : loops) {
      if (loop.path.of_output()) {
        loop.z[n] = y;
      } else {
        loop.z[n] = past_sum(loop.path.n, 0, &inputs[0][at], n) +
                    past_sum(loop.path.m, 1, &loop.phi[n], n) -
                    past_sum(body.denominator, 1, &loop.z[n], n);
      }
      loop.phi[n] = loop.kind->feedback(*loop.effect, loop.z[n], loop.memory);
      y += loop.path.e[0] * loop.phi[n];
    }
    output[at] = y;
    if (!(std::abs(y) < runaway)) return false;
  }
  return true;
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
              std::vector<double>& output) {
  constexpr double kRunaway = 1e6;
  const Signal& measured = signals.output();
  const double runaway = kRunaway * (measured.deviation + std::abs(measured.mean) + 1e-300);
  std::vector<Running> loops;
  for (const Effect* effect : feedback) {
    loops.push_back(
        {effect, &effect_kind(effect->kind), loop_path(*effect, body.order()), {}, {}, {}});
  }
  return std::ranges::all_of(signals.stretches(), [&](const Stretch& stretch) {
    return run_stretch(body, loops, inputs, stretch, runaway, output);
  });
}

}  // namespace stillhand::diagnosis
