// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/carried.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "services/diagnosis/core/apart_from_time.hpp"
#include "services/diagnosis/core/fitting/held_out.hpp"
#include "services/diagnosis/core/fitting/noise_model.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/diagnosis/core/share.hpp"
#include "services/diagnosis/core/trials.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kThirds = 3;  // of a single recording
constexpr double kAsWell = 0.01;    // of an error, as SearchOptions::least_fall
constexpr double kSpreads[] = {0.03, 0.1, 0.3, 1.0,
                               3.0};  // of a prior, of the RMS gain in the band
constexpr int kCarryIterations = 30;
constexpr double kClearlyLower = 0.999;  // of the error of a fit that did not stop short
constexpr const char* kLikeTime =
    "this recording does not distinguish its slow channel from time alone";
constexpr const char* kNotNeeded =
    "parts of the recording are predicted as well without it from the others";

// Each part is whole: thirds of a recording, or the recordings that were joined.
Blocks by_part(const Blocks& blocks, const Signals& signals) {
  if (signals.stretches().back().recording > 0) return by_recording(blocks, signals);
  Blocks result = blocks;
  result.folds = kThirds;
  for (std::size_t b = 0; b < blocks.count; ++b) result.fold.push_back(b * kThirds / blocks.count);
  return result;
}

// The first sample of each part but the first.
std::vector<std::size_t> borders_of(const Blocks& parts) {
  std::vector<std::size_t> borders;
  for (std::size_t b = 1; b < parts.count; ++b) {
    if (parts.fold_of(b) != parts.fold_of(b - 1)) borders.push_back(b * parts.length);
  }
  return borders;
}

// A model's predictions of parts that it was not fitted to, joined.
struct OutOfParts {
  bool finite = false;
  Eigen::VectorXd residual;  ///< [samples] weighted [unit of the output]

  [[nodiscard]] double rmse(double weight) const {
    return finite ? residual.norm() / std::sqrt(weight) : std::numeric_limits<double>::infinity();
  }
};

// With terms that weigh nothing: what the other parts do not determine stays at 0, instead of at
// what the part itself says.
Model bare_of_terms(const Model& model) {
  Model bare = model;
  for (Effect& effect : bare.effects) {
    if (effect.is_whole() && effect_kind(effect.kind).stage(effect) == Stage::kTerm) {
      std::ranges::fill(effect.coefficients, 0.0);
    }
  }
  return bare;
}

// The numbers of its effects are as many as the body's order says.
bool is_bound_to_order(const Model& model) {
  return passes_through_body(model) || std::ranges::any_of(model.effects, [](const Effect& effect) {
           return effect_kind(effect.kind).stage(effect) == Stage::kFeedback;
         });
}

// A map, or a factor on the body's output.
bool scales_body(const Effect& effect) {
  const Stage stage = effect_kind(effect.kind).stage(effect);
  return stage == Stage::kInputValue || stage == Stage::kOutputValue || stage == Stage::kGain;
}

// Only then is the body what the baseline is, or, next to a map or a gain, a multiple of it: a
// delay or a mode takes a part of its response over, and a path through it excites it where the
// inputs do not.
bool has_body_of_baseline(const Model& model, const Signals& signals) {
  return !model.effects.empty() && !passes_through_body(model) &&
         std::ranges::all_of(model.effects, [&](const Effect& effect) {
           const EffectKind& kind = effect_kind(effect.kind);
           return scales_body(effect) ||
                  (kind.stage(effect) == Stage::kTerm && kind.own_poles(effect, signals).empty());
         });
}

class Carrying {
 public:
  // @param signals  bursts weigh nothing
  // @param noise    [samples] what the model of the verdict leaves, weighted
  // @param rms      [unit of the output] of the noise
  Carrying(const Model& found, const Signals& signals, const Blocks& blocks,
           const Eigen::VectorXd& noise, double rms)
      : signals_(signals),
        blocks_(blocks),
        paths_(found, signals, rms),
        parts_(by_part(blocks, signals)),
        apart_(signals.restarted(borders_of(parts_)).whitened(whitening_taps(noise, signals))),
        with_pasts_(apart_.with_pasts()),
        weight_(std::max(sum_of(signals_.weight()), 1.0)) {}

  // Each part by a fit to the others, from the past that `predict` assumes.
  [[nodiscard]] OutOfParts out_of_parts(const Model& model) const {
    OutOfParts out{true, Eigen::VectorXd::Zero(std::ssize(signals_.weight()))};
    for (std::size_t part = 0; part < parts_.folds; ++part) {
      const FreeRun run = free_run(fitted_without(part, model), with_pasts_);
      if (!run.finite) return {};
      const std::vector<double> prediction = apart_.without_pasts(run.prediction);
      for (std::size_t n = 0; n < prediction.size(); ++n) {
        if (parts_.fold_of(n / parts_.length) != part) continue;
        out.residual[static_cast<Eigen::Index>(n)] =
            signals_.weight()[n] * (apart_.output().values[n] - prediction[n]);
      }
    }
    return out;
  }
  [[nodiscard]] double rmse(const Model& model) const { return out_of_parts(model).rmse(weight_); }

  // Of what one model predicts beyond the other, Eq. DG-69: as it is or behind the noise model, by
  // the one with the smaller standard error.
  [[nodiscard]] Share share(const OutOfParts& without, const OutOfParts& with) const {
    if (!with.finite) return {};
    if (!without.finite) return {.estimate = 1.0};
    if (several() && !helps_one(without, with)) return {};
    Eigen::MatrixXd columns(without.residual.size(), 2);
    columns << without.residual, without.residual - with.residual;
    const Share plain = share_of(columns.col(0), columns.col(1), parts_);
    apart_.whiten(columns, signals_.weight());
    Share share = share_of(columns.col(0), columns.col(1), parts_);
    if (plain.std_error < share.std_error) share = plain;
    share.harmless = plain.harmless;  // the error that counts in the end
    return share;
  }

  // Of the body of a model whose effects scale it, or do not, from now on.  The prior stays with
  // the caller.
  void assume(const ResponsePrior& prior, bool of_scaled_body) {
    prior_ = &prior;
    of_scaled_body_ = of_scaled_body;
  }

  // Fitted from its own numbers, from another body's and from a body estimated again; the best end.
  [[nodiscard]] Model refitted(Model model, const Body& other) const {
    FitOptions options;
    options.max_iterations = kCarryIterations;
    options.relative_tolerance = 1e-9;
    options.prior = prior_of(model);
    std::vector<Model> starts(1, model);
    if (other.order() == model.body.order() || !is_bound_to_order(model)) {
      starts.push_back(model);
      starts.back().body = other;
    }
    Model again = model;
    start_afresh(again, signals_, static_cast<int>(other.order()));
    if (again.body.denominator != model.body.denominator) starts.push_back(std::move(again));
    double least = std::numeric_limits<double>::infinity();
    for (Model& start : starts) {
      const FitResult result = fit(start, signals_, blocks_, options);
      if (!result.finite || !(result.rmse < least)) continue;
      least = result.rmse;
      model = start;
    }
    return model;
  }

 private:
  [[nodiscard]] bool several() const { return signals_.stretches().back().recording > 0; }

  // What only one of several recordings shows, none of the others can bear out.
  [[nodiscard]] bool helps_one(const OutOfParts& without, const OutOfParts& with) const {
    std::vector<double> before(parts_.folds, 0.0);
    std::vector<double> after(parts_.folds, 0.0);
    for (Eigen::Index n = 0; n < without.residual.size(); ++n) {
      const std::size_t part = parts_.fold_of(static_cast<std::size_t>(n) / parts_.length);
      before[part] += without.residual[n] * without.residual[n];
      after[part] += with.residual[n] * with.residual[n];
    }
    for (std::size_t part = 0; part < parts_.folds; ++part) {
      if (std::sqrt(after[part]) < (1.0 - kAsWell) * std::sqrt(before[part])) return true;
    }
    return false;
  }

  [[nodiscard]] Signals without_part(std::size_t part) const {
    std::vector<double> weight = signals_.weight();
    for (std::size_t n = 0; n < weight.size(); ++n) {
      if (parts_.fold_of(n / parts_.length) == part) weight[n] = 0.0;
    }
    return signals_.weighed(std::move(weight));
  }

  // With its ranges, from terms that weigh nothing, or from the model's own numbers where that ends
  // clearly lower: from nothing a fit may stop short.
  [[nodiscard]] Model fitted_without(std::size_t part, const Model& model) const {
    FitOptions options;
    options.max_iterations = kCarryIterations;
    options.prior = prior_of(model);
    options.without_fold = static_cast<int>(part);
    Model bare = bare_of_terms(model);
    Model own = model;
    const double from_nothing = fit(bare, signals_, parts_, options).rmse;
    const double from_own = fit(own, signals_, parts_, options).rmse;
    Model& best = from_own < kClearlyLower * from_nothing ? own : bare;
    note_seen(best, without_part(part));
    return best;
  }

  [[nodiscard]] const ResponsePrior* prior_of(const Model& model) const {
    if (passes_through_body(model)) return &paths_;
    const bool fits = has_body_of_baseline(model, signals_) &&
                      std::ranges::any_of(model.effects, scales_body) == of_scaled_body_;
    return fits ? prior_ : nullptr;
  }

  const Signals& signals_;
  const Blocks& blocks_;
  const ResponsePrior* prior_ = nullptr;
  bool of_scaled_body_ = false;
  const ResponsePrior paths_;
  const Blocks parts_;
  const Signals apart_;  // every part starts as a recording does
  const Signals with_pasts_;
  const double weight_;
};

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
Model shared_part(const Model& found, const std::vector<double>& certainty,
                  std::vector<LeftOut>& out) {
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
    } else {
      shared.effects.push_back(effect);
    }
  }
  return shared;
}

// With the narrowest prior that predicts parts of the recording as well from the others as a fit
// without one; with the widest where there is none.
// @param fitted  the shared part is the whole, as it was found
// @param priors  from narrow to wide; they stay as long as `carrying`
Model first_fit(const Model& shared, bool fitted, const Body& baseline, Carrying& carrying,
                const std::vector<ResponsePrior>& priors) {
  const bool as_found = fitted && !passes_through_body(shared);
  Model plain = as_found ? shared : carrying.refitted(shared, baseline);
  if (priors.empty()) return plain;
  const double error = carrying.rmse(plain);
  for (const ResponsePrior& prior : priors) {
    carrying.assume(prior, std::ranges::any_of(shared.effects, scales_body));
    Model with = carrying.refitted(shared, baseline);
    if (&prior == &priors.back() || carrying.rmse(with) <= (1.0 + kAsWell) * error) return with;
  }
  return plain;
}

// From narrow to wide; none where they say nothing.
std::vector<ResponsePrior> priors_of(const Model& shared, const Model& baseline, double noise,
                                     const std::vector<ExcitedBand>& bands,
                                     const Signals& signals) {
  std::vector<ResponsePrior> priors;
  if (!has_body_of_baseline(shared, signals)) return priors;
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

bool has_feedback(const Effect& effect) {
  return effect_kind(effect.kind).stage(effect) == Stage::kFeedback;
}

void drop(CarriedModel& carried, std::size_t effect, const std::string& why, const Body& baseline,
          const Carrying& carrying) {
  carried.left_out.push_back(left_out(carried.model.effects[effect], why));
  carried.model = carrying.refitted(without(carried.model, effect), baseline);
}

// Drops the nonlinearities inside the body of a model that is not stable.
void keep_stable(CarriedModel& carried, const Signals& signals, const Body& baseline,
                 const Carrying& carrying) {
  while (true) {
    Model held = carried.model;
    note_seen(held, signals);
    carried.stability = stability_of(held, signals);
    if (carried.stability != Stability::kRefused) return;
    const auto& effects = carried.model.effects;
    const auto found = std::ranges::find_if(effects, has_feedback);
    if (found == effects.end()) return;  // the body alone: the fit keeps it stable
    drop(carried, static_cast<std::size_t>(found - effects.begin()),
         "with it the model is not stable over the range that was seen", baseline, carrying);
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

// What the evidence leaves of each effect next to the others and of all of them, Eq. DG-68.  One
// that keeps nothing goes, the least of them first, and the others are asked again.
void keep_shares(CarriedModel& carried, const Model& baseline, const Carrying& carrying) {
  const OutOfParts bare = carrying.out_of_parts(baseline);
  while (!carried.model.effects.empty()) {
    const std::size_t count = carried.model.effects.size();
    const OutOfParts with = carrying.out_of_parts(carried.model);
    const double of_all = carrying.share(bare, with).earned();
    std::vector<double> shares(1, of_all);
    if (count > 1) {
      for (std::size_t e = 0; e < count; ++e) {
        const Model other = carrying.refitted(without(carried.model, e), baseline.body);
        const double own = carrying.share(carrying.out_of_parts(other), with).earned();
        shares.resize(count);
        shares[e] = own;
      }
    }
    // Of equals, the one that was added last.
    const auto least = std::ranges::min_element(shares.rbegin(), shares.rend());
    if (*least > 0.0 && of_all > 0.0) {
      for (std::size_t e = 0; e < count; ++e) {
        carried.model.effects[e].share = std::min(shares[e], of_all);
      }
      return;
    }
    drop(carried, static_cast<std::size_t>(shares.rend() - least) - 1, kNotNeeded, baseline.body,
         carrying);
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
                           const Blocks& blocks) {
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
    const Model shared = shared_part(found, certainty, carried.left_out);
    const double rms = noise.norm() / std::sqrt(std::max(sum_of(masked.weight()), 1.0));
    Carrying carrying(found, masked, blocks, noise, rms);
    const std::vector<ResponsePrior> priors =
        priors_of(shared, baseline, rms, carried.bands, signals);
    carried.model = first_fit(shared, carried.left_out.empty(), baseline.body, carrying, priors);
    keep_stable(carried, signals, baseline.body, carrying);
    keep_shares(carried, baseline, carrying);
    for (std::size_t e = carried.model.effects.size(); e-- > 0;) {
      Effect& effect = carried.model.effects[e];
      effect.share = rounded_share(effect.share * certainty[index_of(effect, found)]);
      if (effect.share == 0.0) drop(carried, e, kLikeTime, baseline.body, carrying);
    }
    if (!std::ranges::all_of(carried.model.effects, &Effect::is_whole)) {
      carried.model = carrying.refitted(carried.model, baseline.body);
    }
    keep_stable(carried, signals, baseline.body, carrying);
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

CarriedModel carried_as_it_is(Model model) { return {model, model, {}, {}, {}, {}}; }

}  // namespace stillhand::diagnosis
