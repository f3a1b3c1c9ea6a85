// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/stability.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/model_run.hpp"
#include "services/core/diagnosis/model/other_phases.hpp"
#include "services/core/diagnosis/model/seen_range.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr int kFrequencies = 4096;  // between 0 and half the rate
constexpr double kScales[] = {1.0, 1.5};
constexpr int kSurrogates = 2;
constexpr double kMostGrowth = 5.0;  // of the largest output, over that of the inputs
constexpr double kMostApart = 0.02;  // of the largest output, from another past, after half the way
constexpr std::uint64_t kSeed = 57;

// Of phi over its range, in units of z; 0 is among them, as phi is held beyond.
struct Slopes {
  double least = 0.0;
  double most = 0.0;
  bool remembers = false;  // another phi at the same z
};

// By differences of a four hundredth of the range.
Slopes slopes_of(const Effect& effect, const Body& body, double lowest, double highest) {
  constexpr int kSteps = 400;
  const Nonlinearity nonlinearity = effect_kind(effect.kind).feedback(effect);
  const double stop = nonlinearity.stop ? *nonlinearity.stop - body.offset : 0.0;
  const double width = highest - lowest;
  Slopes slopes;
  if (!(width > 0.0)) return slopes;
  LoopMemory memory;
  std::vector<double> up;
  const auto phi_of = [&](double z) {
    return nonlinearity.phi((z - stop) / nonlinearity.threshold, memory);
  };
  double before = phi_of(lowest);
  const double largest = std::abs(before) + 1.0;
  // Up, down and up again: an element with memory takes another way back.
  for (int way = 0; way < 3; ++way) {
    for (int i = 0; i <= kSteps; ++i) {
      const double share = static_cast<double>(way == 1 ? kSteps - i : i) / kSteps;
      const double z = lowest + share * width;
      const double phi = phi_of(z);
      if (i > 0) {
        const double slope = (way == 1 ? before - phi : phi - before) * kSteps / width;
        slopes.least = std::min(slopes.least, slope);
        slopes.most = std::max(slopes.most, slope);
      }
      before = phi;
      if (way == 0) up.push_back(phi);
      if (way == 1 && std::abs(phi - up[static_cast<std::size_t>(kSteps - i)]) > 1e-9 * largest) {
        slopes.remembers = true;
      }
    }
  }
  return slopes;
}

using Polynomial = std::vector<double>;

Polynomial closed(const Polynomial& a, double slope, const Polynomial& path) {
  Polynomial c = a;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] -= slope * path[i];
  for (std::size_t i = c.size(); i-- > 0;) c[i] /= c[0];
  return c;
}

bool poles_inside(const Polynomial& denominator) {
  const signal::DifferenceModel model{1.0, denominator, denominator};
  return signal::well_formed(model) && signal::is_stable(model);
}

std::complex<double> at(const Polynomial& c, double turn_rad) {
  return signal::polynomial_at(c, std::polar(1.0, -turn_rad));
}

// Eq. DG-57 c: the circle criterion for differences of two runs.
bool contracts(const Polynomial& a, const Polynomial& path, const Slopes& slopes) {
  const Polynomial low = closed(a, slopes.least, path);
  const Polynomial high = closed(a, slopes.most, path);
  for (int i = 0; i <= kFrequencies; ++i) {
    const double turn_rad = std::numbers::pi * i / kFrequencies;
    if (!((at(low, turn_rad) * std::conj(at(high, turn_rad))).real() > 0.0)) return false;
  }
  return true;
}

// Eq. DG-57 d: the loop on its own inputs and on others of the same spectrum.
class TriedLoop {
 public:
  TriedLoop(const Model& model, const Effect& feedback, const Signals& signals)
      : model_(model), feedback_(feedback), signals_(signals) {
    run_all(model, signals, own_);
    usual_ = largest_of(own_.free.body, 0);
    for (const Stretch& stretch : signals.stretches()) {
      if (stretch.end - stretch.first > longest_.end - longest_.first) longest_ = stretch;
    }
  }

  // Bounded by what is usual, and the same in the end from another past.
  [[nodiscard]] bool is_tame() const {
    if (!own_.free.finite) return false;
    for (int surrogate = 0; surrogate <= kSurrogates; ++surrogate) {
      for (const double scale : kScales) {
        const auto one = output_of(surrogate, scale, 0.0);
        const auto other = output_of(surrogate, scale, 1.0);
        if (one.empty() || other.empty()) return false;
        if (largest_of(one, 0) > kMostGrowth * scale * usual_) return false;
        std::vector<double> apart = one;
        for (std::size_t n = 0; n < apart.size(); ++n) apart[n] -= other[n];
        if (largest_of(apart, (longest_.first + longest_.end) / 2) > kMostApart * usual_) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  // Largest in the longest stretch from `first` on; 0: anywhere.
  [[nodiscard]] double largest_of(const std::vector<double>& x, std::size_t first) const {
    double largest = 0.0;
    for (std::size_t n = first; n < (first == 0 ? x.size() : longest_.end); ++n) {
      largest = std::max(largest, std::abs(x[n]));
    }
    return largest;
  }

  // Empty: it ran away.  @param past  what the inputs held before, in deviations
  [[nodiscard]] std::vector<double> output_of(int surrogate, double scale, double past) const {
    std::vector<Settled> inputs;
    for (std::size_t k = 0; k < own_.inputs.size(); ++k) {
      std::vector<double> u = own_.inputs[k].values;
      if (surrogate > 0) u = other_phases(u, {kSeed, static_cast<std::uint64_t>(surrogate)});
      for (double& value : u) value *= scale;
      inputs.push_back(settled(std::move(u), signals_));
      for (double& level : inputs.back().before) level += past * signals_.inputs()[k].deviation;
    }
    const LoopCase loop{&model_.body, &feedback_, &inputs};
    LoopRun run;
    run_loops(std::span(&loop, 1), signals_, std::span(&run, 1));
    return run.finite ? std::move(run.output) : std::vector<double>();
  }

  const Model& model_;
  const Effect& feedback_;
  const Signals& signals_;
  ModelRun own_;
  double usual_ = 0.0;
  Stretch longest_;
};

// Eq. DG-57 b and c.
bool is_proved(const Body& body, const Effect& effect) {
  const LoopPath path = loop_path(effect, body.order());
  const Polynomial back = path.to_argument(body.denominator);
  const SeenRange& range = effect.seen.front();
  const Slopes slopes = slopes_of(effect, body, range.lower_edge(), range.upper_edge());
  return !slopes.remembers && poles_inside(closed(body.denominator, slopes.least, back)) &&
         contracts(body.denominator, back, slopes);
}

}  // namespace

bool turns_round(const Model& fitted, const Signals& signals) {
  constexpr double kNone = 0.1;  // of the largest: a stiffness of 0 comes out a little off
  if (feedback_of(fitted) == nullptr) return false;
  Model model = fitted;
  note_seen(model, signals);
  const Effect& effect = *feedback_of(model);
  const Polynomial& a = model.body.denominator;
  const SeenRange& range = effect.seen.front();
  const Slopes slopes = slopes_of(effect, model.body, range.low, range.high);
  const double linear = at(a, 0.0).real();
  const double path = at(loop_path(effect, model.body.order()).to_argument(a), 0.0).real();
  const auto [least, most] =
      std::minmax({linear - slopes.least * path, linear - slopes.most * path});
  return least < -kNone * most;
}

Stability stability_of(const Model& fitted, const Signals& signals) {
  // As a file's reader has it: without the fit's bounds, on which a pole lies to rounding.
  Model model = fitted;
  model.body.largest_radius = model.body.slowest_radius = 1.0;
  if (!is_stable(model.body)) return Stability::kRefused;
  const Effect* feedback = feedback_of(model);
  if (feedback == nullptr) return Stability::kProved;
  const bool held = !feedback->seen.empty();
  if (!held || !TriedLoop(model, *feedback, signals).is_tame()) return Stability::kRefused;
  return is_proved(model.body, *feedback) ? Stability::kProved : Stability::kTested;
}

std::string name_of(Stability stability) {
  if (stability == Stability::kProved) return "proved";
  return stability == Stability::kTested ? "tested" : "refused";
}

}  // namespace stillhand::diagnosis
