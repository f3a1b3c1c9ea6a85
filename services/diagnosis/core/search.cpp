// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/core/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "diagnosis/core/screening.hpp"
#include "statistics/signed_rank.hpp"

namespace stillhand::diagnosis {
namespace {

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Mean squares of the blocks that count in both.
struct BlockDifferences {
  std::vector<double> before;
  std::vector<double> after;
};

BlockDifferences mean_squares(const HeldOut& before, const HeldOut& after) {
  BlockDifferences result;
  for (std::size_t b = 0; b < before.squares.size(); ++b) {
    if (before.weights[b] < 1.0 || after.weights[b] < 1.0) continue;
    result.before.push_back(before.squares[b] / before.weights[b]);
    result.after.push_back(after.squares[b] / after.weights[b]);
  }
  return result;
}

// Held-out error of a model at its fit, without refitting.
HeldOut judged(const Model& model, const Signals& signals, const Blocks& blocks) {
  const Linearisation line = linearised(model, signals);
  if (!line.finite) return {};
  return held_out_linearised(grams_of(line.jacobian, line.residual, line.run.weight, blocks),
                             blocks);
}

Trial judged_trial(Model model, const Signals& signals, const Blocks& blocks, int iterations,
                   bool refitting) {
  Trial trial;
  FitOptions options;
  options.max_iterations = iterations;
  options.relative_tolerance = 1e-8;
  fit(model, signals, blocks, options);
  trial.held_out = refitting ? held_out(model, signals, blocks) : judged(model, signals, blocks);
  trial.rmse =
      trial.held_out.finite ? trial.held_out.rmse() : std::numeric_limits<double>::infinity();
  trial.added = model.effects.empty() ? 0 : model.effects.size() - 1;
  trial.model = std::move(model);
  return trial;
}

// The body that was fitted without the effect may sit in a hollow that the effect has made void:
// one estimated anew from what the effect leaves of the output, where that is better.  Of the order
// that was asked for, too: what the effect did may have hidden poles of a body taken down.
void start_afresh(Model& model, const Signals& signals, int order) {
  constexpr double kWorthPoles = 0.98;  // of the squared error
  std::vector<double> left = signals.output().values;
  std::vector<std::vector<double>> inputs;
  if (!without_effects(model, signals, inputs, left)) return;
  const bool bound_to_order = std::ranges::any_of(model.effects, [](const Effect& effect) {
    return effect_kind(effect.kind).through_body(effect);
  });
  FreeRun run;
  double least = residual_of(model, signals, run).squaredNorm();
  const auto own = static_cast<int>(model.body.order());
  for (const int p : {own, order}) {
    if (p > own && bound_to_order) break;
    Model other = model;
    other.body = started_body(inputs, left, {}, signals, p);
    if (p == 4) other.body = with_other_mode(other.body, inputs, left, signals);
    const double square = residual_of(other, signals, run).squaredNorm();
    if (run.finite && square < (p > own ? kWorthPoles : 1.0) * least) {
      least = square;
      model = std::move(other);
    }
    if (p == order) break;
  }
}

bool by_rmse(const Trial& a, const Trial& b) { return a.rmse < b.rmse; }

bool passes_over_samples(const Trial& trial) {
  const Effect& effect = trial.model.effects.back();
  return effect_kind(effect.kind).stage(effect) == Stage::kWeight;
}

// Everything that is proposed, fitted jointly in two passes: a few steps for all, then to the end
// for those near the best.
std::vector<Trial> trials(const Model& current, double current_rmse, const Signals& signals,
                          const Blocks& blocks, const ImpulseResponse& impulse_response, int order,
                          const SearchOptions& options, const ForEach& for_each) {
  constexpr double kNear = 1.35;
  constexpr double kGains = 0.985;
  constexpr double kExplainsMuch = 0.85;
  constexpr std::size_t kFewest = 5;
  const Screening screening(current, signals, blocks, impulse_response);
  const auto& kinds = effect_kinds();
  std::vector<std::vector<Proposal>> proposals(kinds.size());
  for_each(kinds.size(), [&](std::size_t k) { proposals[k] = kinds[k]->proposed(screening); });
  std::vector<Model> models;
  for (const auto& of_kind : proposals) {
    for (const Proposal& proposal : of_kind) {
      Model model = current;
      if (proposal.body) model.body = *proposal.body;
      model.effects.push_back(proposal.effect);
      models.push_back(std::move(model));
    }
  }
  std::vector<Trial> all(models.size());
  for_each(models.size(), [&](std::size_t i) {
    all[i] =
        judged_trial(std::move(models[i]), signals, blocks, options.screening_iterations, false);
  });
  std::ranges::stable_sort(all, by_rmse);
  // Where nothing gains, a few are carried to the end all the same: some begin slowly.
  std::size_t near = 0;
  while (near < all.size() && all[near].rmse < kNear * all.front().rmse &&
         (near < kFewest || all[near].rmse < kGains * current_rmse)) {
    ++near;
  }
  for_each(std::min(near, kFewest),
           [&](std::size_t i) { start_afresh(all[i].model, signals, order); });
  for_each(near, [&](std::size_t i) {
    all[i] = judged_trial(std::move(all[i].model), signals, blocks, options.fit_iterations, true);
  });
  std::ranges::stable_sort(all, by_rmse);
  // To pass over samples explains nothing: only where no effect explains much.
  const auto explains = std::ranges::find_if_not(all, passes_over_samples);
  if (explains != all.end() && explains->rmse < kExplainsMuch * current_rmse) {
    std::erase_if(all, passes_over_samples);
  }
  return all;
}

// True when `other` explains as much as the best: the blocks don't tell them apart (one standard
// error), or its error is hardly larger and it has nearly all of the gain.
bool ties_with(const Trial& other, const Trial& best, double current_rmse,
               const SearchOptions& options) {
  if (compared(other.held_out, best.held_out).t < 1.0) return true;
  const auto gain = [&](const Trial& trial) {
    return current_rmse * current_rmse - trial.rmse * trial.rmse;
  };
  return other.rmse <= (1.0 + options.tie) * best.rmse &&
         gain(other) >= options.tied_gain * gain(best);
}

std::size_t simplest(const std::vector<Trial>& tried, double current_rmse,
                     const SearchOptions& options) {
  std::size_t chosen = 0;
  for (std::size_t i = 1; i < tried.size(); ++i) {
    if (!std::isfinite(tried[i].rmse) || !ties_with(tried[i], tried[0], current_rmse, options)) {
      continue;
    }
    const std::size_t mine = complexity(tried[i].model);
    const std::size_t best = complexity(tried[chosen].model);
    if (mine < best) chosen = i;
  }
  return chosen;
}

std::vector<std::string> tied_kinds(const std::vector<Trial>& tried, std::size_t chosen,
                                    double current_rmse, const SearchOptions& options) {
  std::vector<std::string> kinds;
  const std::string& own = tried[chosen].model.effects.back().kind;
  for (const Trial& trial : tried) {
    if (!std::isfinite(trial.rmse)) continue;
    const std::string& kind = trial.model.effects.back().kind;
    if (kind == own || std::ranges::find(kinds, kind) != kinds.end()) continue;
    if (ties_with(trial, tried[chosen], current_rmse, options)) kinds.push_back(kind);
  }
  return kinds;
}

bool worth_it(const Comparison& comparison, const SearchOptions& options, double least_fall,
              std::size_t candidates) {
  const double fall = 1.0 - comparison.rmse_ratio;
  if (fall >= options.large_fall) return comparison.p < options.large_significance;
  return fall > least_fall && comparison.p * static_cast<double>(candidates) < options.significance;
}

// Drops effects that the later ones have made idle.  True when one left.
bool retest(SearchResult& result, const Signals& signals, const Blocks& blocks,
            const SearchOptions& options) {
  for (std::size_t e = 0; e + 1 < result.model.effects.size(); ++e) {
    const Effect& effect = result.model.effects[e];
    if (effect_kind(effect.kind).stage(effect) == Stage::kWeight) continue;
    Model without = result.model;
    without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(e));
    const Trial trial =
        judged_trial(std::move(without), signals, blocks, options.fit_iterations, true);
    const HeldOut with = held_out(result.model, signals, blocks);
    if (!trial.held_out.finite ||
        worth_it(compared(trial.held_out, with), options, options.least_fall, 1))
      continue;
    result.model = trial.model;
    result.additions.erase(result.additions.begin() + static_cast<std::ptrdiff_t>(e));
    return true;
  }
  return false;
}

}  // namespace

void in_order(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t i = 0; i < count; ++i) task(i);
}

Comparison compared(const HeldOut& before, const HeldOut& after) {
  Comparison result;
  const BlockDifferences blocks = mean_squares(before, after);
  const auto count = static_cast<double>(blocks.before.size());
  if (blocks.before.size() < 3) return result;
  result.rmse_ratio = std::sqrt(sum_of(blocks.after) / std::max(sum_of(blocks.before), 1e-300));
  double mean = 0.0;
  std::vector<double> differences;
  for (std::size_t b = 0; b < blocks.before.size(); ++b) {
    differences.push_back(blocks.before[b] - blocks.after[b]);
    mean += differences.back() / count;
    if (blocks.after[b] < blocks.before[b]) result.share_better += 1.0 / count;
  }
  double square = 0.0;
  for (std::size_t b = 0; b < blocks.before.size(); ++b) {
    square += std::pow(blocks.before[b] - blocks.after[b] - mean, 2);
  }
  const double error = std::sqrt(square / (count - 1.0) / count);
  result.t = error > 0.0 ? mean / error : (mean > 0.0 ? 1e6 : 0.0);
  result.p = statistics::signed_rank_p(differences);
  return result;
}

SearchResult search(const Baseline& baseline, const Signals& signals, const Blocks& blocks,
                    const SearchOptions& options, const ForEach& for_each,
                    const std::function<bool(const std::string&)>& progress) {
  SearchResult result;
  result.model = baseline.model;
  const ImpulseResponse impulse_response = fit_impulse_response(signals);
  HeldOut current = held_out(result.model, signals, blocks);
  while (progress("effect " + std::to_string(result.additions.size() + 1))) {
    std::vector<Trial> tried = trials(result.model, current.rmse(), signals, blocks,
                                      impulse_response, baseline.order, options, for_each);
    if (tried.empty() || !std::isfinite(tried.front().rmse)) break;
    const std::size_t chosen = simplest(tried, current.rmse(), options);
    const Comparison comparison = compared(current, tried[chosen].held_out);
    // Bursts lie in few blocks, whose signs say little; that they stand out has been asked already.
    const bool bursts = passes_over_samples(tried[chosen]);
    const bool good =
        bursts ? 1.0 - comparison.rmse_ratio > options.large_fall
               : worth_it(comparison, options,
                          result.additions.empty() ? options.first_least_fall : options.least_fall,
                          tried.size());
    if (!good || result.additions.size() == options.most_effects) {
      result.last_tried = std::move(tried);
      break;
    }
    Addition addition{current, tried[chosen].held_out, comparison, std::move(tried), chosen, {}};
    addition.ties = tied_kinds(addition.tried, chosen, current.rmse(), options);
    result.model = addition.tried[chosen].model;
    result.additions.push_back(std::move(addition));
    if (retest(result, signals, blocks, options)) ++result.removed;
    if (result.removed > options.most_effects) break;  // it goes in circles
    current = held_out(result.model, signals, blocks);
  }
  return result;
}

}  // namespace stillhand::diagnosis
