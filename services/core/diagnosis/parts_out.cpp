// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/parts_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/seen_range.hpp"
#include "services/core/diagnosis/trials.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kThirds = 3;  // of a single recording
constexpr double kHelps = 0.01;     // of an error, as SearchOptions::least_fall
constexpr int kIterations = 30;
constexpr double kLeastNoise = 1e-9;     // of the output
constexpr std::size_t kPieces = 10;      // of a long record, to which a fit goes
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
    if (effect.is_whole() && acts_at(effect, Stage::kTerm)) {
      std::ranges::fill(effect.coefficients, 0.0);
    }
  }
  return bare;
}

// What a run's first rows depend on: Eq. DG-54 looks a second ahead.
std::vector<Stretch> heads_of(const Signals& signals, std::size_t given) {
  const std::size_t length = std::max(given, static_cast<std::size_t>(signals.rate_hz()) + 1);
  std::vector<Stretch> heads = signals.stretches();
  for (Stretch& head : heads) head.end = std::min(head.end, head.first + length);
  return heads;
}

// The first rows of each stretch.
GivenRows first_rows(const Signals& signals, std::size_t given) {
  GivenRows rows;
  for (const Stretch& stretch : signals.stretches()) {
    const std::size_t count = std::min(given, stretch.end - stretch.first);
    rows.emplace_back(count);
    std::iota(rows.back().begin(), rows.back().end(), stretch.first);
  }
  return rows;
}

// The rows that a fit without one part goes to: of a long record pieces of the other parts, as many
// as a round screens.  Nothing of the part is among them.
std::vector<Stretch> rest_of(const Signals& apart, const Blocks& parts, std::size_t part) {
  std::vector<Stretch> others = apart.stretches();
  std::erase_if(others, [&](const Stretch& each) {
    return parts.fold_of(each.first / parts.length) == part;
  });
  const std::size_t scale = parts.folds * kPieces / (parts.folds - 1);
  return spread_pieces(others, scale, kMostScreened / kPieces * scale, apart.rate_hz());
}

// The numbers of its effects are as many as the body's order says.
bool is_bound_to_order(const Model& model) {
  return passes_through_body(model) || feedback_of(model) != nullptr;
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
           return scales_body(effect) || (kind.stage(effect) == Stage::kTerm &&
                                          kind.own_poles(effect, signals.rate_hz()).empty());
         });
}

PartsOut::PartsOut(const Model& found, const Signals& signals, const Blocks& blocks,
                   const Eigen::VectorXd& noise, double rms, std::size_t given)
    : signals_(signals),
      blocks_(blocks),
      paths_(found, signals, rms),
      parts_(by_part(blocks, signals)),
      apart_(signals.restarted(borders_of(parts_)).whitened(whitening_taps(noise, signals))),
      with_pasts_(apart_.with_pasts()),
      heads_(apart_.cut_to(heads_of(apart_, given))),
      given_(first_rows(heads_, given)) {
  // A slow body's level lasts through a piece.
  if (signals.size() <= kMostScreened || signals.slow_poles() || several()) return;
  const Signals cut = signals.restarted(borders_of(parts_));
  for (std::size_t part = 0; part < parts_.folds; ++part) {
    rests_.push_back(cut.cut_to(rest_of(cut, parts_, part)));
  }
}

OutOfParts PartsOut::left_by(const Model& model) const {
  const auto size = std::ssize(signals_.weight());
  OutOfParts out{true, Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
  const auto& measured = apart_.output().values;
  for (std::size_t part = 0; part < parts_.folds; ++part) {
    const Fitted fitted = fitted_without(part, model);
    const FreeRun rested = free_run(fitted.model, with_pasts_);
    const FreeRun started = run_from_start(fitted.model, fitted.rmse);
    if (!rested.finite || !started.finite) return {};
    const std::vector<double> prediction = apart_.without_pasts(rested.prediction);
    for (std::size_t n = 0; n < prediction.size(); ++n) {
      if (parts_.fold_of(n / parts_.length) != part) continue;
      const auto at = static_cast<Eigen::Index>(n);
      out.residual[at] = signals_.weight()[n] * (measured[n] - prediction[n]);
      out.started[at] = signals_.weight()[n] * (measured[n] - started.prediction[n]);
    }
  }
  for (std::size_t s = 0; s < given_.size(); ++s) {
    out.started
        .segment(static_cast<Eigen::Index>(apart_.stretches()[s].first), std::ssize(given_[s]))
        .setZero();
  }
  return out;
}

FreeRun PartsOut::run_from_start(const Model& model, double noise) const {
  const auto states = most_likely_start(
      model, heads_, spread_of(model, apart_), heads_.output().values, given_,
      std::max(noise, kLeastNoise * apart_.output().deviation),
      [&](const Signals& signals) { return free_run(model, signals).prediction; });
  return free_run(model, started(model, apart_, states));
}

// A body that holds a level says nothing from a past that it does not know.
const Eigen::VectorXd& PartsOut::judged(const OutOfParts& out) const {
  return signals_.slow_poles() ? out.started : out.residual;
}

double PartsOut::rmse(const Model& model) const {
  const OutOfParts out = left_by(model);
  if (!out.finite) return std::numeric_limits<double>::infinity();
  return judged(out).norm() / std::sqrt(std::max(sum_of(signals_.weight()), 1.0));
}

HeldOut PartsOut::from_start(const Model& model) const {
  const OutOfParts out = left_by(model);
  HeldOut by_block;
  by_block.finite = out.finite;
  by_block.squares.assign(parts_.count, out.finite ? 0.0 : HUGE_VAL);
  by_block.weights.assign(parts_.count, 0.0);
  for (std::size_t n = 0; n < signals_.size(); ++n) {
    const std::size_t block = n / parts_.length;
    by_block.weights[block] += signals_.weight()[n];
    if (out.finite)
      by_block.squares[block] += std::pow(out.started[static_cast<Eigen::Index>(n)], 2);
  }
  return by_block;
}

double PartsOut::slow_share(const OutOfParts& without, const OutOfParts& with) const {
  const double period = apart_.rate_hz() / apart_.lowest_excited_hz();
  return diagnosis::slow_share(judged(without) - judged(with), apart_.stretches(),
                               static_cast<std::size_t>(period));
}

Share PartsOut::share(const OutOfParts& without, const OutOfParts& with) const {
  if (!with.finite) return {};
  if (!without.finite) return {.estimate = 1.0};
  if (several() && !helps_one(without, with)) return {};
  Eigen::MatrixXd columns(judged(without).size(), 2);
  columns << judged(without), judged(without) - judged(with);
  const Share plain = share_of(columns.col(0), columns.col(1), parts_);
  apart_.whiten(columns, signals_.weight());
  Share share = share_of(columns.col(0), columns.col(1), parts_);
  if (plain.std_error < share.std_error) share = plain;
  // The error that counts in the end, from either start.
  for (const auto start : {&OutOfParts::residual, &OutOfParts::started}) {
    share.harmless = std::min(
        share.harmless, share_of(without.*start, without.*start - with.*start, parts_).harmless);
  }
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
  const Signals some = screened_part(signals_);
  const bool all = some.size() == signals_.size();
  double least = std::numeric_limits<double>::infinity();
  for (Model& start : starts) {
    const FitResult result = fit(start, some, all ? blocks_ : make_blocks(some), options);
    if (!result.finite || !(result.rmse < least)) continue;
    least = result.rmse;
    model = start;
  }
  if (!all) fit(model, signals_, blocks_, options);
  return model;
}

// What only one of several recordings shows, none of the others can bear out.
bool PartsOut::helps_one(const OutOfParts& without, const OutOfParts& with) const {
  std::vector<double> before(parts_.folds, 0.0);
  std::vector<double> after(parts_.folds, 0.0);
  for (Eigen::Index n = 0; n < judged(without).size(); ++n) {
    const std::size_t part = parts_.fold_of(static_cast<std::size_t>(n) / parts_.length);
    before[part] += std::pow(judged(without)[n], 2);
    after[part] += std::pow(judged(with)[n], 2);
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
PartsOut::Fitted PartsOut::fitted_without(std::size_t part, const Model& model) const {
  FitOptions options;
  options.max_iterations = kIterations;
  options.prior = prior_of(model);
  if (rests_.empty()) options.without_fold = static_cast<int>(part);
  const Signals& rest = rests_.empty() ? signals_ : rests_[part];
  const Blocks blocks = rests_.empty() ? parts_ : make_blocks(rest);
  Model bare = bare_of_terms(model);
  const bool has_terms = packed(bare) != packed(model);
  Fitted best{model, 0.0};
  best.rmse = fit(best.model, rest, blocks, options).rmse;
  if (has_terms) {
    const double from_nothing = fit(bare, rest, blocks, options).rmse;
    if (!(best.rmse < kClearlyLower * from_nothing)) best = {std::move(bare), from_nothing};
  }
  note_seen(best.model, without_part(part));
  return best;
}

const ResponsePrior* PartsOut::prior_of(const Model& model) const {
  if (passes_through_body(model)) return &paths_;
  const bool fits = has_body_of_baseline(model, signals_) &&
                    std::ranges::any_of(model.effects, scales_body) == of_scaled_body_;
  return fits ? prior_ : nullptr;
}

}  // namespace stillhand::diagnosis
