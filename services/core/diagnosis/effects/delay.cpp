// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/map_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/interpolation.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kEarliest_s = -0.1;  // the input's own sensor may be late, too
constexpr double kLatest_s = 0.5;
// Local minima of the error lie a few samples of 10 ms apart.
constexpr double kTriedDelays_s[] = {-0.03, 0.02, 0.04, 0.06, 0.08, 0.1,
                                     0.13,  0.16, 0.2,  0.25, 0.3};
constexpr std::size_t kThorough = 4;
constexpr double kFiner_s[] = {0.01, 0.005, 0.0025};
constexpr double kMinimum_s = 0.015;
// Of the squared error: bodies without the effects that the model already has leave so much more
// that no step of a delay makes up for it.  A delay that is there gains at once, or loses some
// hundredths (2026-11-24, white and low-pass noise).
constexpr double kHopeless = -0.25;

/// A pure delay of the input that the body's poles and zeros do not provide:
///
///   u(t - d)
///
/// Source: METHOD Eq. DG-20, by the fractional delay of DG-2, Laakso et al. (1996).
class Delay final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "delay"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kInputTime; }
  [[nodiscard]] double input_delay_s(const Effect& effect, double /*time_s*/) const override {
    return effect.value(0);
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "the output follows the input " + with_unit(1e3 * effect.value(0), "ms") +
           " later than the poles and zeros of the body provide";
  }
};

std::vector<std::vector<double>> delayed_inputs(const Signals& signals, double delay_s) {
  std::vector<std::vector<double>> inputs;
  for (const Signal& input : signals.inputs()) {
    inputs.push_back(delayed(input.values, signals, [&](double) { return delay_s; }));
  }
  return inputs;
}

Effect delay_of(double delay_s) {
  return {"delay", "of the input", {}, {{"delay", "s", delay_s, kEarliest_s, kLatest_s}}, {}};
}

// A delay moves the poles: each trial starts from a body of its own.
Proposal with_own_body(const Screening& screening, double delay_s) {
  const Signals& signals = screening.signals();
  const auto order = static_cast<int>(screening.model().body.order());
  return with_body(screening, delay_of(delay_s),
                   started_body(delayed_inputs(signals, delay_s), signals.output().values,
                                screening.impulse_response(), signals, order));
}

// Whose other mode is sought, too.
Proposal with_best_modes(const Screening& screening, const Proposal& from) {
  if (from.body->order() != 4) return from;
  const Signals& signals = screening.signals();
  const double delay_s = from.effect.value(0);
  return with_body(screening, delay_of(delay_s),
                   with_other_mode(*from.body, delayed_inputs(signals, delay_s),
                                   signals.output().values, signals));
}

// A few milliseconds move the poles a little: from those of the next delay.
Proposal with_moved_poles(const Screening& screening, const Proposal& from, double delay_s) {
  const Signals& signals = screening.signals();
  return with_body(
      screening, delay_of(delay_s),
      refined_body(*from.body, delayed_inputs(signals, delay_s), signals.output().values, signals));
}

std::vector<Proposal> Delay::proposed(const Screening& screening) const {
  const Body& body = screening.model().body;
  for (const Effect& effect : screening.model().effects) {
    if (effect.kind == name()) return {};
  }
  if (body.order() == 0) {
    return {{{"delay", "of the input", {}, {{"delay", "s", 0.02, kEarliest_s, kLatest_s}}, {}},
             0.0,
             {}}};
  }
  std::vector<Proposal> proposals = screening.known(name());
  const bool known = !proposals.empty();
  if (known) {
    for (Proposal& each : proposals) {
      each = with_moved_poles(screening, each, each.effect.value(0));
    }
  } else {
    for (const double delay_s : kTriedDelays_s) {
      proposals.push_back(with_own_body(screening, delay_s));
    }
  }
  // The order among the first few depends on bodies that may be in a local minimum.
  proposals = best_of(std::move(proposals), kThorough);
  if (proposals.front().gain < kHopeless) return {proposals.front()};
  if (!known) {
    for (Proposal& each : proposals) each = with_best_modes(screening, each);
    proposals = best_of(std::move(proposals), kThorough);
  }
  Proposal best = proposals.front();
  for (const double step_s : kFiner_s) {
    const Proposal from = best;
    for (const double direction : {-1.0, 1.0}) {
      const double delay_s =
          std::clamp(from.effect.value(0) + direction * step_s, kEarliest_s, kLatest_s);
      Proposal next = with_moved_poles(screening, from, delay_s);
      if (next.gain > best.gain) best = std::move(next);
    }
  }
  // Another minimum may be as deep once it is fitted: the best beyond this one.
  const auto other = std::ranges::find_if(proposals, [&](const Proposal& each) {
    return std::abs(each.effect.value(0) - best.effect.value(0)) > kMinimum_s;
  });
  if (other == proposals.end()) return {best};
  return {best, *other};
}

}  // namespace

const EffectKind& delay_kind() {
  static const Delay kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis
