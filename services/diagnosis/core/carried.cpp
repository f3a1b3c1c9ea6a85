// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/carried.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "services/diagnosis/core/apart_from_time.hpp"
#include "services/diagnosis/core/fitting/held_out.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/diagnosis/core/trials.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kThirds = 3;  // of a single recording
constexpr double kHelps = 0.01;     // of a recording's error, as SearchOptions::least_fall
constexpr double kSpreads[] = {0.03, 0.1, 0.3, 1.0,
                               3.0};  // of a prior, of the RMS gain in the band
constexpr int kCarryIterations = 30;
constexpr int kPartIterations = 3;

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

struct PartErrors {
  std::vector<double> squares;  ///< [parts] mean squares
  double rmse = std::numeric_limits<double>::infinity();
  /// Of the model as it is, fitted to all parts, from the past that `predict` assumes: a mode that
  /// rings for longer than a part lasts is fitted by its start, which no other recording shares.
  double own_rmse = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool is_below(const PartErrors& other) const {
    return rmse < other.rmse && own_rmse < other.own_rmse;
  }
};

// With terms that weigh nothing: what the other parts do not determine stays at 0, instead of at
// what the part itself says.
Model bare_of_terms(const Model& model) {
  Model bare = model;
  for (Effect& effect : bare.effects) {
    if (effect_kind(effect.kind).stage(effect) == Stage::kTerm) {
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

// [unit of the output]
double rms_error(const Model& model, const Signals& signals) {
  const FreeRun run = free_run(model, signals);
  if (!run.finite) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t n = 0; n < signals.size(); ++n) {
    const double r = run.weight[n] * (signals.output().values[n] - run.prediction[n]);
    sum += r * r;
    weight += run.weight[n];
  }
  return std::sqrt(sum / std::max(weight, 1.0));
}

class Carrying {
 public:
  Carrying(const Signals& signals, const Signals& without_bursts, const Blocks& blocks)
      : all_(signals),
        fitted_(without_bursts),
        blocks_(blocks),
        parts_(by_part(blocks, signals)),
        apart_(signals.restarted(borders_of(parts_))),
        with_pasts_(apart_.with_pasts()) {}

  [[nodiscard]] bool several() const { return all_.stretches().back().recording > 0; }

  // Error of each part, by a fit to the others, from the past that `predict` assumes; bursts are
  // left out of the fits alone.
  [[nodiscard]] PartErrors errors(const Model& model, const Signals& fitted) const {
    PartErrors errors;
    errors.own_rmse = rms_error(model, with_pasts_);
    double sum = 0.0;
    double weight = 0.0;
    for (std::size_t part = 0; part < parts_.folds; ++part) {
      Model refitted = bare_of_terms(model);
      FitOptions options;
      options.max_iterations = kPartIterations;
      options.prior = prior_of(model);
      options.without_fold = static_cast<int>(part);
      fit(refitted, fitted, parts_, options);
      const FreeRun run = free_run(refitted, with_pasts_);
      if (!run.finite) return {};
      const std::vector<double> prediction = apart_.without_pasts(run.prediction);
      const std::vector<double> weight_of_run = apart_.without_pasts(run.weight);
      double of_part = 0.0;
      double weight_of_part = 0.0;
      for (std::size_t n = 0; n < all_.size(); ++n) {
        if (parts_.fold_of(n / parts_.length) != part) continue;
        const double r = weight_of_run[n] * (all_.output().values[n] - prediction[n]);
        of_part += r * r;
        weight_of_part += weight_of_run[n];
      }
      errors.squares.push_back(of_part / std::max(weight_of_part, 1.0));
      sum += of_part;
      weight += weight_of_part;
    }
    errors.rmse = std::sqrt(sum / std::max(weight, 1.0));
    return errors;
  }
  [[nodiscard]] PartErrors errors(const Model& model) const { return errors(model, fitted_); }
  [[nodiscard]] PartErrors errors_of_baseline(const Model& model) const {
    return errors(model, all_);
  }

  // Of the body, from now on.  The prior stays with the caller.
  void assume(const ResponsePrior& prior) { prior_ = &prior; }

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
    start_afresh(again, fitted_, static_cast<int>(other.order()));
    if (again.body.denominator != model.body.denominator) starts.push_back(std::move(again));
    double least = std::numeric_limits<double>::infinity();
    for (Model& start : starts) {
      const FitResult result = fit(start, fitted_, blocks_, options);
      if (!result.finite || !(result.rmse < least)) continue;
      least = result.rmse;
      model = start;
    }
    return model;
  }

 private:
  [[nodiscard]] const ResponsePrior* prior_of(const Model& model) const {
    return prior_ != nullptr && has_body_of_baseline(model, all_) ? prior_ : nullptr;
  }

  const Signals& all_;
  const Signals& fitted_;
  const Blocks& blocks_;
  const ResponsePrior* prior_ = nullptr;
  const Blocks parts_;
  const Signals apart_;  // every part starts as a recording does
  const Signals with_pasts_;
};

LeftOut left_out(const Effect& effect, std::string why) {
  return {effect.kind, effect.form, effect.channels, std::move(why)};
}

void leave_all(const Model& model, const std::string& why, std::vector<LeftOut>& out) {
  for (const Effect& effect : model.effects) out.push_back(left_out(effect, why));
}

// The part of a model that another recording can share; the rest goes to `out`.
Model shared_part(const Model& found, const Signals& signals, const Blocks& blocks,
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
    } else if (!is_apart_from_time(found, e, signals, blocks)) {
      out.push_back(
          left_out(effect, "this recording does not distinguish its slow channel from time alone"));
      out.back().like_time = true;
    } else {
      shared.effects.push_back(effect);
    }
  }
  return shared;
}

// With the narrowest prior that predicts parts of the recording as well from the others as a fit
// without one.  If the samples contradict each, the body has a response outside of the band that
// the baseline's does not have, and neither is known: nothing is carried.
// @param fitted  the shared part is the whole, as it was found
// @param priors  from narrow to wide; they stay as long as `carrying`
std::optional<Model> first_fit(const Model& shared, bool fitted, const Body& baseline,
                               Carrying& carrying, const std::vector<ResponsePrior>& priors) {
  Model plain = fitted ? shared : carrying.refitted(shared, baseline);
  if (priors.empty()) return plain;
  const double error = carrying.errors(plain).rmse;
  for (const ResponsePrior& prior : priors) {
    carrying.assume(prior);
    Model with = carrying.refitted(shared, baseline);
    if (carrying.errors(with).rmse <= (1.0 + kHelps) * error) return with;
  }
  return std::nullopt;
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

// The effect, last added first, without which the parts are predicted as well or better, or that
// helps none of several recordings.
std::optional<std::size_t> idle(const Model& model, const PartErrors& with, const Body& baseline,
                                const Carrying& carrying) {
  if (model.effects.size() < 2 && !carrying.several()) return std::nullopt;
  for (std::size_t e = model.effects.size(); e-- > 0;) {
    const PartErrors bare = carrying.errors(carrying.refitted(without(model, e), baseline));
    if (!with.is_below(bare)) return e;
    if (!carrying.several()) continue;
    bool helps = bare.squares.empty();  // without it the model's run is not finite
    for (std::size_t r = 0; r < bare.squares.size(); ++r) {
      helps = helps || std::sqrt(with.squares[r] / bare.squares[r]) < 1.0 - kHelps;
    }
    if (!helps) return e;
  }
  return std::nullopt;
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
    Carrying carrying(signals, masked, blocks);
    const Model shared = shared_part(found, signals, blocks, carried.left_out);
    const std::vector<ResponsePrior> priors =
        priors_of(shared, baseline, rms_error(found, masked), carried.bands, signals);
    const auto first = first_fit(shared, carried.left_out.empty(), baseline.body, carrying, priors);
    carried.model = first.value_or(baseline);
    if (!first) {
      leave_all(shared,
                "next to it the body differs from the linear model's where nothing excited it",
                carried.left_out);
    }
    keep_stable(carried, signals, baseline.body, carrying);
    PartErrors errors = carrying.errors(carried.model);
    while (const auto effect = idle(carried.model, errors, baseline.body, carrying)) {
      drop(carried, *effect,
           carrying.several() ? "it helps to predict no recording that it was not fitted to"
                              : "it helps to predict no third of the recording from the others",
           baseline.body, carrying);
      errors = carrying.errors(carried.model);
    }
    keep_stable(carried, signals, baseline.body, carrying);
    // A body that was fitted next to effects that stay behind is as right as the baseline's where
    // the recording is excited.  Elsewhere neither is known, and the baseline is what it is
    // compared with.
    if (carried.model.effects.empty() ||
        !carrying.errors(carried.model).is_below(carrying.errors_of_baseline(baseline))) {
      leave_all(carried.model,
                "parts of the recording are predicted as well without it from the others",
                carried.left_out);
      carried.model = baseline;
    }
  }
  note_seen(carried.model, signals);
  carried.stability = stability_of(carried.model, signals);
  return carried;
}

CarriedModel carried_as_it_is(Model model) { return {std::move(model), {}, {}, {}, {}}; }

}  // namespace stillhand::diagnosis
