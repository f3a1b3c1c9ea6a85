// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/carried.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "services/core/diagnosis/apart_from_time.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/parts_out.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kAsWell = 0.01;  // of an error, as SearchOptions::least_fall
constexpr double kSpreads[] = {0.03, 0.1, 0.3, 1.0,
                               3.0};  // of a prior, of the RMS gain in the band
constexpr int kCarryIterations = 30;
constexpr const char* kLikeTime =
    "this recording does not distinguish its slow channel from time alone";
constexpr const char* kLikeSlowNoise =
    "most of what it adds is slower than the motion, and slow noise looks like it";
constexpr const char* kNotNeeded =
    "a fit to one part of the recording predicts the others as well without it";

LeftOut left_out(const Effect& effect, std::string why) {
  return {{effect.kind, effect.form, effect.channels, {}, {}}, std::move(why)};
}

// [effects] that an effect is not one of time alone, Eq. DG-59.
std::vector<double> certainty_of(const Model& found, const Signals& signals, const Blocks& blocks) {
  std::vector<double> certainty(found.effects.size(), 1.0);
  for (std::size_t e = 0; e < certainty.size(); ++e) {
    if (effect_kind(found.effects[e].kind).time_only(found.effects[e])) continue;
    certainty[e] = rounded_share(apart_from_time(found, e, signals, blocks));
  }
  return certainty;
}

std::size_t index_of(const Effect& effect, const Model& found) {
  const auto same = std::ranges::find_if(found.effects,
                                         [&](const Effect& each) { return is_same(each, effect); });
  return static_cast<std::size_t>(same - found.effects.begin());
}

// The part of a model that another recording can share; the rest goes to `out`.
// @param counts  [effects]; empty: all do
Model shared_part(const Model& found, const std::vector<double>& certainty,
                  const std::vector<bool>& counts, std::vector<LeftOut>& out) {
  Model shared = found;
  shared.effects.clear();
  for (std::size_t e = 0; e < found.effects.size(); ++e) {
    const Effect& effect = found.effects[e];
    const EffectKind& kind = effect_kind(effect.kind);
    if (kind.stage(effect) == Stage::kWeight) {
      out.push_back(left_out(effect, "nothing predicts when a burst comes"));
    } else if (kind.time_only(effect)) {
      out.push_back(left_out(effect, "the inputs do not determine it"));
    } else if (certainty[e] == 0.0) {
      out.push_back(left_out(effect, kLikeTime));
      out.back().like_time = true;
    } else if (!counts.empty() && !counts[e]) {
      out.push_back(left_out(effect, "its force is less than what counts"));
    } else {
      shared.effects.push_back(effect);
    }
  }
  return shared;
}

// With the narrowest prior that predicts parts of the recording as well from the others as a fit
// without one; with the widest where there is none.
// @param fitted  the shared part is the whole, as it was found
// @param priors  from narrow to wide; they stay as long as `parts`
Model first_fit(const Model& shared, bool fitted, const Body& baseline, PartsOut& parts,
                const std::vector<ResponsePrior>& priors) {
  const bool as_found = fitted && !passes_through_body(shared);
  Model plain = as_found ? shared : parts.refitted(shared, baseline);
  if (priors.empty()) return plain;
  const double error = parts.rmse(plain);
  for (const ResponsePrior& prior : priors) {
    parts.assume(prior, std::ranges::any_of(shared.effects, scales_body));
    Model with = parts.refitted(shared, baseline);
    if (&prior == &priors.back() || parts.rmse(with) <= (1.0 + kAsWell) * error) return with;
  }
  return plain;
}

// What leaves more says nothing of the body behind a map.
bool explains_half(const Model& baseline, const Signals& signals) {
  FreeRun run;
  const double left = residual_of(baseline, signals, run).squaredNorm();
  const double deviation = signals.output().deviation;
  return left < 0.5 * deviation * deviation * sum_of(run.weight);
}

// From narrow to wide; none where they say nothing.
std::vector<ResponsePrior> priors_of(const Model& shared, const Model& baseline, double noise,
                                     const std::vector<ExcitedBand>& bands,
                                     const Signals& signals) {
  std::vector<ResponsePrior> priors;
  if (!has_body_of_baseline(shared, signals) || !explains_half(baseline, signals)) return priors;
  const Body assumed = std::ranges::any_of(shared.effects, scales_body)
                           ? scaled_to(shared.body, baseline.body, bands, baseline.rate_hz)
                           : baseline.body;
  for (const double spread : kSpreads) {
    priors.emplace_back(assumed, bands, baseline.rate_hz, noise, spread);
    if (priors.back().empty()) return {};
  }
  return priors;
}

Model without(const Model& model, std::size_t effect) {
  Model other = model;
  other.effects.erase(other.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  return other;
}

void drop(CarriedModel& carried, std::size_t effect, const std::string& why, const Body& baseline,
          const PartsOut& parts) {
  carried.left_out.push_back(left_out(carried.model.effects[effect], why));
  carried.model = parts.refitted(without(carried.model, effect), baseline);
}

// Drops the nonlinearity inside the body of a model that is not stable.
void keep_stable(CarriedModel& carried, const Signals& signals, const Body& baseline,
                 const PartsOut& parts) {
  while (true) {
    Model held = carried.model;
    note_seen(held, signals);
    carried.stability = stability_of(held, signals);
    if (carried.stability != Stability::kRefused) return;
    const Effect* feedback = feedback_of(carried.model);
    if (feedback == nullptr) return;  // the body alone: the fit keeps it stable
    drop(carried, static_cast<std::size_t>(feedback - carried.model.effects.data()),
         "with it the model is not stable over the range that was seen", baseline, parts);
  }
}

Signals bursts_masked(const Model& found, const Signals& signals) {
  std::vector<double> weight = signals.weight();
  for (const Effect& effect : found.effects) {
    const EffectKind& kind = effect_kind(effect.kind);
    if (kind.stage(effect) == Stage::kWeight) kind.weigh(effect, signals, weight);
  }
  return signals.weighed(std::move(weight));
}

// A law whose force turns with its argument: it moves as the motion does.  So may a curve, whose
// heights are never exactly odd.
bool is_odd_feedback(const Effect& effect) {
  if (!acts_at(effect, Stage::kFeedback)) return false;
  if (effect_kind(effect.kind).any_shape()) return true;
  const Nonlinearity law = effect_kind(effect.kind).feedback(effect);
  return std::ranges::all_of(std::array{0.3, 1.0, 3.0}, [&](double z) {
    LoopMemory one;
    LoopMemory other;
    return std::abs(law.phi(z, one) + law.phi(-z, other)) < 1e-9;
  });
}

// The share that an effect has earned, and why if that is nothing.
struct Earned {
  double share = 0.0;
  const char* why = kNotNeeded;
};

Earned earned_by(const Effect& effect, const OutOfParts& without, const OutOfParts& with,
                 const PartsOut& parts) {
  constexpr double kMostSlow = 0.5;  // Eq. DG-77
  const double earned = parts.share(without, with).earned();
  const bool slow =
      earned > 0.0 && is_odd_feedback(effect) && parts.slow_share(without, with) > kMostSlow;
  return slow ? Earned{0.0, kLikeSlowNoise} : Earned{earned};
}

// What the evidence leaves of each effect next to the others and of all of them, Eq. DG-68.  One
// that keeps nothing goes, the least of them first, and the others are asked again.
void keep_shares(CarriedModel& carried, const Model& baseline, const PartsOut& parts) {
  const OutOfParts bare = parts.left_by(baseline);
  while (!carried.model.effects.empty()) {
    const std::size_t count = carried.model.effects.size();
    const OutOfParts with = parts.left_by(carried.model);
    const double of_all = parts.share(bare, with).earned();
    std::vector<Earned> earned;
    for (std::size_t e = 0; e < count; ++e) {
      const OutOfParts other =
          count == 1 ? bare
                     : parts.left_by(parts.refitted(without(carried.model, e), baseline.body));
      earned.push_back(earned_by(carried.model.effects[e], other, with, parts));
    }
    // Of equals, the one that was added last.
    const auto least = std::ranges::min_element(earned.rbegin(), earned.rend(), {}, &Earned::share);
    if (least->share > 0.0 && of_all > 0.0) {
      for (std::size_t e = 0; e < count; ++e) {
        // One without numbers has no size that could be smaller.
        Effect& effect = carried.model.effects[e];
        effect.share = complexity(effect) == 0 ? 1.0 : std::min(earned[e].share, of_all);
      }
      return;
    }
    drop(carried, static_cast<std::size_t>(earned.rend() - least) - 1, least->why, baseline.body,
         parts);
  }
}

void make_whole(CarriedModel& carried, const Body& baseline, const PartsOut& parts) {
  auto& effects = carried.model.effects;
  if (std::ranges::all_of(effects, &Effect::is_whole)) return;
  for (Effect& effect : effects) effect.share = 1.0;
  carried.model = parts.refitted(carried.model, baseline);
}

// Shares by the evidence of the parts and, Eq. DG-59, of slow channels; the body fitted to them.
// Effects that make up for each other need equal shares, so the whole is judged once more.
void keep_evident(CarriedModel& carried, const std::vector<double>& certainty, const Model& found,
                  const Model& baseline, const PartsOut& parts) {
  auto& effects = carried.model.effects;
  for (;;) {
    make_whole(carried, baseline.body, parts);
    keep_shares(carried, baseline, parts);
    for (std::size_t e = effects.size(); e-- > 0;) {
      effects[e].share = rounded_share(effects[e].share * certainty[index_of(effects[e], found)]);
      if (effects[e].share == 0.0) drop(carried, e, kLikeTime, baseline.body, parts);
    }
    if (std::ranges::all_of(effects, &Effect::is_whole)) return;
    carried.model = parts.refitted(carried.model, baseline.body);
    const Share share = parts.share(parts.left_by(baseline), parts.left_by(carried.model));
    if (share.estimate > 0.0 && share.harmless >= 1.0) return;
    const auto least = std::ranges::min_element(effects, {}, &Effect::share);
    drop(carried, static_cast<std::size_t>(least - effects.begin()), kNotNeeded, baseline.body,
         parts);
  }
}

// The carried model next to the effects of time alone that were found, fitted again together.
Model with_time(const Model& carried, const Model& found, const Signals& signals,
                const Blocks& blocks) {
  Model whole = carried;
  for (const Effect& effect : found.effects) {
    if (effect_kind(effect.kind).time_only(effect)) whole.effects.push_back(effect);
  }
  if (whole.effects.size() == carried.effects.size()) return whole;
  for (Effect& effect : whole.effects) effect.seen.clear();
  FitOptions options;
  options.max_iterations = kCarryIterations;
  fit(whole, signals, blocks, options);
  for (std::size_t e = 0; e < carried.effects.size(); ++e) {
    whole.effects[e].seen = carried.effects[e].seen;
  }
  return whole;
}

}  // namespace

CarriedModel carried_model(const Model& found, const Model& baseline, const Signals& signals,
                           const Blocks& blocks, const std::vector<bool>& counts) {
  CarriedModel carried;
  carried.inputs = input_ranges(signals);
  for (const Signal& input : signals.inputs()) {
    carried.bands.push_back(excited_band(input.name, input.values, input.mean, signals.rate_hz()));
  }
  carried.model = baseline;
  if (!found.effects.empty()) {
    const Signals masked = bursts_masked(found, signals);
    FreeRun run;
    const Eigen::VectorXd noise = residual_of(found, masked, run);
    const std::vector<double> certainty = certainty_of(found, signals, blocks);
    const Model shared = shared_part(found, certainty, counts, carried.left_out);
    const double rms = noise.norm() / std::sqrt(std::max(sum_of(masked.weight()), 1.0));
    PartsOut parts(found, masked, blocks, noise, rms, kGivenForANumber * state_size(found));
    const std::vector<ResponsePrior> priors =
        priors_of(shared, baseline, rms, carried.bands, signals);
    carried.model = first_fit(shared, carried.left_out.empty(), baseline.body, parts, priors);
    keep_stable(carried, signals, baseline.body, parts);
    // One that leaves because the model is not stable may have made up for another.
    for (std::size_t count = 0; count != carried.model.effects.size();) {
      keep_evident(carried, certainty, found, baseline, parts);
      count = carried.model.effects.size();
      keep_stable(carried, signals, baseline.body, parts);
    }
    // A body that was fitted next to effects that stay behind is as right as the baseline's where
    // the recording is excited.  Elsewhere neither is known, and the baseline is what it is
    // compared with.
    if (carried.model.effects.empty()) carried.model = baseline;
  }
  note_seen(carried.model, signals);
  carried.stability = stability_of(carried.model, signals);
  carried.in_session = with_time(carried.model, found, signals, blocks);
  return carried;
}

CarriedModel carried_as_it_is(Model model) { return {model, std::move(model), {}, {}, {}, {}}; }

}  // namespace stillhand::diagnosis
