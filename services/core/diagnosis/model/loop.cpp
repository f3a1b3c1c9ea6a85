// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "services/core/contract/expects.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnosis {
namespace {

// q^-1 sum c_i D^i by powers of q^-1.
std::vector<double> late(std::span<const double> coefficients) {
  std::vector<double> powers = difference_basis({coefficients.begin(), coefficients.end()});
  powers.insert(powers.begin(), 0.0);
  return powers;
}

// Runs of one body with different numbers go through the recursion side by side: each waits for its
// own last sample, and meanwhile the others are computed.
template <std::size_t L>
using Lanes = std::array<double, L>;

// One run's nonlinearity.
struct Running {
  Nonlinearity nonlinearity;
  LoopPath path;
  double low = -HUGE_VAL;  // phi is held beyond
  double high = HUGE_VAL;
  double stop = 0.0;  // of y_b
  LoopMemory memory{};

  double phi_of(double at) {
    return nonlinearity.phi((std::clamp(at, low, high) - stop) / nonlinearity.threshold, memory);
  }
};

// Coefficients by power of q^-1 and lane.
template <std::size_t L>
using Taps = std::vector<Lanes<L>>;
// A signal of a stretch behind as many samples as the body looks back.
template <std::size_t L>
using Padded = std::vector<Lanes<L>>;

// sum += sign sum_{i = from..P} taps_i newest_{-i}; the newest comes last: what follows waits for
// that product alone.
template <std::size_t P, std::size_t L>
void add_past(const Lanes<L>* taps, std::ptrdiff_t from, std::size_t order, const Lanes<L>* newest,
              double sign, Lanes<L>& sum) {
  const auto last = static_cast<std::ptrdiff_t>(P == 0 ? order : P);
#pragma GCC unroll 8
  for (std::ptrdiff_t i = last; i >= from; --i) {
    const Lanes<L>& tap = taps[i];
    const Lanes<L>& past = newest[-i];
    for (std::size_t l = 0; l < L; ++l) sum[l] += sign * tap[l] * past[l];
  }
}

template <std::size_t L>
struct StretchRun {
  std::array<Running, L> loops;
  bool of_output = false;
  Taps<L> a, e, n, m;
  std::vector<Taps<L>> b;
  std::vector<Padded<L>> inputs;
  Padded<L> output, z, phi;
  std::array<std::size_t, L> end{};  // of what is written before a run ran away
};

// For a body of order P; 0: of any.  The fit spends most of its time here.
template <std::size_t P, std::size_t L>
void run_stretch(std::size_t order, double runaway, StretchRun<L>& run) {
  run.end.fill(run.output.size());
  for (std::size_t n = order; n < run.output.size(); ++n) {
    Lanes<L> y{};
    for (std::size_t k = 0; k < run.inputs.size(); ++k) {
      add_past<P, L>(run.b[k].data(), 0, order, &run.inputs[k][n], 1.0, y);
    }
    add_past<P, L>(run.e.data(), 1, order, &run.phi[n], 1.0, y);
    add_past<P, L>(run.a.data(), 1, order, &run.output[n], -1.0, y);
    Lanes<L> z = y;
    if (!run.of_output) {
      z = {};
      add_past<P, L>(run.n.data(), 0, order, &run.inputs[0][n], 1.0, z);
      add_past<P, L>(run.a.data(), 1, order, &run.z[n], -1.0, z);
      add_past<P, L>(run.m.data(), 1, order, &run.phi[n], 1.0, z);
    }
    run.z[n] = z;
    for (std::size_t l = 0; l < L; ++l) {
      run.phi[n][l] = run.loops[l].phi_of(z[l]);
      y[l] += run.e[0][l] * run.phi[n][l];
    }
    run.output[n] = y;
    bool bounded = true;
    for (std::size_t l = 0; l < L; ++l) bounded = bounded && std::abs(y[l]) < runaway;
    if (bounded) continue;
    bool all_ended = true;
    for (std::size_t l = 0; l < L; ++l) {
      if (!(std::abs(y[l]) < runaway)) run.end[l] = std::min(run.end[l], n + 1);
      all_ended = all_ended && run.end[l] <= n + 1;
    }
    if (all_ended) return;
  }
}

template <std::size_t L>
void run_stretch_of_order(std::size_t order, double runaway, StretchRun<L>& run) {
  switch (order) {
    case 2:
      return run_stretch<2, L>(order, runaway, run);
    case 3:
      return run_stretch<3, L>(order, runaway, run);
    case 4:
      return run_stretch<4, L>(order, runaway, run);
    case 6:
      return run_stretch<6, L>(order, runaway, run);
    default:
      return run_stretch<0, L>(order, runaway, run);
  }
}

double sum_of(const std::vector<double>& c) { return std::accumulate(c.begin(), c.end(), 0.0); }

// What everything holds before a stretch, under the inputs' levels.
struct Rest {
  double output = 0.0;
  double z = 0.0;
  double phi = 0.0;
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

Rest rest_of(const Body& body, Running& loop, const std::vector<double>& levels) {
  const double a = sum_of(body.denominator);
  double linear = 0.0;
  for (std::size_t k = 0; k < levels.size(); ++k) linear += sum_of(body.numerators[k]) * levels[k];
  const LoopPath& path = loop.path;
  const double without = path.of_output() ? linear / a : sum_of(path.n) * levels[0] / a;
  const double z = equilibrium(loop, without, sum_of(path.to_argument(body.denominator)) / a);
  const double phi = phi_afresh(loop, z);
  return {linear / a + sum_of(path.e) / a * phi, z, phi};
}

}  // namespace

bool fits_loop(std::size_t coefficients, const Nonlinearity& nonlinearity, std::size_t order) {
  if (nonlinearity.stop) return coefficients == 0 && order > 0;
  return coefficients == order || coefficients == 3 * order + 2;
}

Effect at_order(Effect effect, std::size_t from, std::size_t to) {
  std::vector<std::size_t> lengths;  // of each polynomial, less the order
  const EffectKind& kind = effect_kind(effect.kind);
  const std::vector<double> all = std::move(effect.coefficients);
  if (kind.through_body(effect)) {
    lengths.assign(all.size() / (from + 1), 1);
  } else if (kind.stage(effect) == Stage::kFeedback && all.size() == from) {
    lengths = {0};
  } else if (kind.stage(effect) == Stage::kFeedback && !all.empty()) {
    lengths = {1, 1, 0};
  }
  effect.coefficients = lengths.empty() ? all : std::vector<double>();
  auto next = all.begin();
  for (const std::size_t more : lengths) {
    std::vector<double> polynomial(next, next + static_cast<std::ptrdiff_t>(from + more));
    next += std::ssize(polynomial);
    polynomial.resize(to + more, 0.0);
    effect.coefficients.insert(effect.coefficients.end(), polynomial.begin(), polynomial.end());
  }
  return effect;
}

std::vector<double> LoopPath::to_argument(const std::vector<double>& denominator) const {
  if (!of_output()) return m;
  std::vector<double> path = e;
  for (std::size_t i = 0; i < path.size(); ++i) path[i] -= e[0] * denominator[i];
  return path;
}

LoopPath loop_path(const Effect& effect, std::size_t order) {
  const Nonlinearity nonlinearity = effect_kind(effect.kind).feedback(effect);
  STILLHAND_EXPECTS(fits_loop(effect.coefficients.size(), nonlinearity, order));
  const std::span<const double> all(effect.coefficients);
  LoopPath path;
  const auto in_part = [&](std::vector<double> e) {
    for (double& each : e) each *= effect.share;
    return e;
  };
  if (nonlinearity.stop) {
    path.e.assign(order + 1, 0.0);
    path.e.front() = -effect.share;
    return path;
  }
  if (all.size() == order) {
    path.e = in_part(late(all));
    return path;
  }
  const auto powers = [](std::span<const double> part) {
    return difference_basis({part.begin(), part.end()});
  };
  path.e = in_part(powers(all.first(order + 1)));
  path.n = powers(all.subspan(order + 1, order + 1));
  path.m = late(all.last(order));
  return path;
}

namespace {

Running running(const LoopCase& each) {
  const Effect& effect = *each.feedback;
  Running loop{effect_kind(effect.kind).feedback(effect), loop_path(effect, each.body->order())};
  if (loop.nonlinearity.stop) {
    loop.stop = *loop.nonlinearity.stop - each.body->offset;
  } else if (!effect.seen.empty()) {
    loop.low = effect.seen.front().lower_edge();
    loop.high = effect.seen.front().upper_edge();
  }
  return loop;
}

// Up to L cases of one structure; the lanes behind the last case repeat it.
template <std::size_t L>
class LoopBatch {
 public:
  LoopBatch(std::span<const LoopCase> cases, const Signals& signals, std::span<LoopRun> runs)
      : cases_(cases),
        signals_(signals),
        runs_(runs),
        order_(cases.front().body->order()),
        runaway_(runaway_bound(signals.output())) {
    for (std::size_t l = 0; l < L; ++l) stretch_.loops[l] = running(case_of(l));
    lay_out();
    for (LoopRun& run : runs_) {
      for (auto* each : {&run.output, &run.argument, &run.phi}) each->assign(signals.size(), 0.0);
      run.output_before.clear();
      run.phi_before.clear();
      run.finite = true;
    }
  }

  void run() {
    for (std::size_t s = 0; s < signals_.stretches().size(); ++s) {
      if (std::ranges::none_of(runs_, &LoopRun::finite)) return;
      begin(s);
      run_stretch_of_order<L>(order_, runaway_, stretch_);
      for (std::size_t l = 0; l < runs_.size(); ++l) {
        if (runs_[l].finite) take(l, signals_.stretches()[s]);
      }
    }
  }

 private:
  [[nodiscard]] const LoopCase& case_of(std::size_t lane) const {
    return cases_[std::min(lane, cases_.size() - 1)];
  }

  // taps_i of every lane
  template <class TapsOf>
  Taps<L> taps(const TapsOf& of) const {
    Taps<L> result(order_ + 1);
    for (std::size_t l = 0; l < L; ++l) {
      const std::vector<double>& own = of(l);
      for (std::size_t i = 0; i < own.size(); ++i) result[i][l] = own[i];
    }
    return result;
  }

  void lay_out() {
    const auto& loops = stretch_.loops;
    stretch_.of_output = loops[0].path.of_output();
    stretch_.a = taps([&](std::size_t l) -> auto& { return case_of(l).body->denominator; });
    stretch_.e = taps([&](std::size_t l) -> auto& { return loops[l].path.e; });
    stretch_.n = taps([&](std::size_t l) -> auto& { return loops[l].path.n; });
    stretch_.m = taps([&](std::size_t l) -> auto& { return loops[l].path.m; });
    for (std::size_t k = 0; k < case_of(0).inputs->size(); ++k) {
      stretch_.b.push_back(
          taps([&](std::size_t l) -> auto& { return case_of(l).body->numerators[k]; }));
    }
    stretch_.inputs.resize(stretch_.b.size());
  }

  void begin(std::size_t s) {
    const Stretch& stretch = signals_.stretches()[s];
    const std::size_t length = order_ + stretch.end - stretch.first;
    for (auto& input : stretch_.inputs) input.resize(length);
    for (auto* each : {&stretch_.output, &stretch_.z, &stretch_.phi}) each->resize(length);
    for (std::size_t l = 0; l < L; ++l) begin_lane(l, s, stretch, length);
  }

  void begin_lane(std::size_t l, std::size_t s, const Stretch& stretch, std::size_t length) {
    const std::vector<Settled>& inputs = *case_of(l).inputs;
    std::vector<double> levels;
    levels.reserve(inputs.size());
    for (const Settled& input : inputs) levels.push_back(input.before[s]);
    const Rest rest = rest_of(*case_of(l).body, stretch_.loops[l], levels);
    if (l < runs_.size() && runs_[l].finite) {
      runs_[l].output_before.push_back(rest.output);
      runs_[l].phi_before.push_back(rest.phi);
    }
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      for (std::size_t n = 0; n < order_; ++n) stretch_.inputs[k][n][l] = levels[k];
      for (std::size_t n = order_; n < length; ++n) {
        stretch_.inputs[k][n][l] = inputs[k].values[stretch.first + n - order_];
      }
    }
    stretch_.loops[l].memory = {};
    for (std::size_t n = 0; n < length; ++n) {
      stretch_.output[n][l] = rest.output;
      stretch_.z[n][l] = rest.z;
      stretch_.phi[n][l] = rest.phi;
    }
  }

  void take(std::size_t l, const Stretch& stretch) {
    LoopRun& run = runs_[l];
    const std::size_t end = stretch_.end[l];
    for (std::size_t n = order_; n < end; ++n) {
      const std::size_t to = stretch.first + n - order_;
      run.output[to] = stretch_.output[n][l];
      run.argument[to] = stretch_.z[n][l];
      run.phi[to] = stretch_.phi[n][l];
    }
    std::fill(run.output.begin() + static_cast<std::ptrdiff_t>(stretch.first + end - order_),
              run.output.begin() + static_cast<std::ptrdiff_t>(stretch.end),
              run.output_before.back());
    run.finite = end == stretch_.output.size() && std::abs(run.output[stretch.end - 1]) < runaway_;
  }

  std::span<const LoopCase> cases_;
  const Signals& signals_;
  std::span<LoopRun> runs_;
  std::size_t order_;
  double runaway_;
  StretchRun<L> stretch_;
};

}  // namespace

void run_loops(std::span<const LoopCase> cases, const Signals& signals, std::span<LoopRun> runs) {
  while (!cases.empty()) {
    const std::size_t count = std::min(cases.size(), kLoopLanes);
    if (count == 1) {
      LoopBatch<1>(cases.first(1), signals, runs.first(1)).run();
    } else {
      LoopBatch<kLoopLanes>(cases.first(count), signals, runs.first(count)).run();
    }
    cases = cases.subspan(count);
    runs = runs.subspan(count);
  }
}

}  // namespace stillhand::diagnosis
