// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/parts_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/seen_range.hpp"
#include "services/core/diagnosis/trials.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kThirds = 3;  // of a single recording
constexpr double kHelps = 0.01;     // of an error, as SearchOptions::least_fall
constexpr int kIterations = 30;
constexpr double kClearlyLower = 0.999;  // of the error of a fit that did not stop short

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

}  // namespace

bool scales_body(const Effect& effect) {
  const Stage stage = effect_kind(effect.kind).stage(effect);
  return stage == Stage::kInputValue || stage == Stage::kOutputValue || stage == Stage::kGain;
}

bool has_body_of_baseline(const Model& model, const Signals& signals) {
  return !model.effects.empty() && !passes_through_body(model) &&
         std::ranges::all_of(model.effects, [&](const Effect& effect) {
           const EffectKind& kind = effect_kind(effect.kind);
           return scales_body(effect) ||
                  (kind.stage(effect) == Stage::kTerm && kind.own_poles(effect, signals).empty());
         });
}

PartsOut::PartsOut(const Model& found, const Signals& signals, const Blocks& blocks,
                   const Eigen::VectorXd& noise, double rms)
    : signals_(signals),
      blocks_(blocks),
      paths_(found, signals, rms),
      parts_(by_part(blocks, signals)),
      apart_(signals.restarted(borders_of(parts_)).whitened(whitening_taps(noise, signals))),
      with_pasts_(apart_.with_pasts()) {}

OutOfParts PartsOut::left_by(const Model& model) const {
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
double PartsOut::rmse(const Model& model) const {
  const OutOfParts out = left_by(model);
  if (!out.finite) return std::numeric_limits<double>::infinity();
  return out.residual.norm() / std::sqrt(std::max(sum_of(signals_.weight()), 1.0));
}

double PartsOut::slow_share(const OutOfParts& without, const OutOfParts& with) const {
  const double period = apart_.rate_hz() / apart_.lowest_excited_hz();
  return diagnosis::slow_share(without.residual - with.residual, apart_.stretches(),
                               static_cast<std::size_t>(period));
}

Share PartsOut::share(const OutOfParts& without, const OutOfParts& with) const {
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

void PartsOut::assume(const ResponsePrior& prior, bool of_scaled_body) {
  prior_ = &prior;
  of_scaled_body_ = of_scaled_body;
}

Model PartsOut::refitted(Model model, const Body& other) const {
  FitOptions options;
  options.max_iterations = kIterations;
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

// What only one of several recordings shows, none of the others can bear out.
bool PartsOut::helps_one(const OutOfParts& without, const OutOfParts& with) const {
  std::vector<double> before(parts_.folds, 0.0);
  std::vector<double> after(parts_.folds, 0.0);
  for (Eigen::Index n = 0; n < without.residual.size(); ++n) {
    const std::size_t part = parts_.fold_of(static_cast<std::size_t>(n) / parts_.length);
    before[part] += without.residual[n] * without.residual[n];
    after[part] += with.residual[n] * with.residual[n];
  }
  for (std::size_t part = 0; part < parts_.folds; ++part) {
    if (std::sqrt(after[part]) < (1.0 - kHelps) * std::sqrt(before[part])) return true;
  }
  return false;
}

Signals PartsOut::without_part(std::size_t part) const {
  std::vector<double> weight = signals_.weight();
  for (std::size_t n = 0; n < weight.size(); ++n) {
    if (parts_.fold_of(n / parts_.length) == part) weight[n] = 0.0;
  }
  return signals_.weighed(std::move(weight));
}

// With its ranges, from terms that weigh nothing, or from the model's own numbers where that ends
// clearly lower: from nothing a fit may stop short.
Model PartsOut::fitted_without(std::size_t part, const Model& model) const {
  FitOptions options;
  options.max_iterations = kIterations;
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

const ResponsePrior* PartsOut::prior_of(const Model& model) const {
  if (passes_through_body(model)) return &paths_;
  const bool fits = has_body_of_baseline(model, signals_) &&
                    std::ranges::any_of(model.effects, scales_body) == of_scaled_body_;
  return fits ? prior_ : nullptr;
}

}  // namespace stillhand::diagnosis
