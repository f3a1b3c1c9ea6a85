// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "services/core/diagnosis/detection/surrogates.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/statistics/sample_check.hpp"
#include "services/core/statistics/signed_rank.hpp"

namespace stillhand::diagnosis {
namespace {

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

// In the list of kinds.
std::ptrdiff_t place_of(const std::string& kind) {
  return std::ranges::find(effect_kinds(), kind, &EffectKind::name) - effect_kinds().begin();
}

bool shows_in_rows(const Trial& trial) {
  const Effect& effect = trial.model.effects.back();
  return effect_kind(effect.kind).shows_in_rows(effect);
}

// METHOD Eq. DG-50: an error and what its numbers cost.
double schwarz(const Trial& trial) {
  if (!std::isfinite(trial.rmse) || is_by_chance(trial)) {
    return std::numeric_limits<double>::infinity();
  }
  const double samples = sum_of(trial.held_out.weights);
  return 2.0 * samples * std::log(std::max(trial.rmse, 1e-300)) +
         static_cast<double>(complexity(trial.model)) * std::log(samples);
}

}  // namespace

Comparison compared(const HeldOut& before, const HeldOut& after) {
  Comparison result;
  const BlockDifferences blocks = mean_squares(before, after);
  const auto count = static_cast<double>(blocks.before.size());
  if (blocks.before.size() < 3) return result;
  if (!(std::max(sum_of(blocks.before), sum_of(blocks.after)) <= statistics::kLargestMagnitude)) {
    return result;
  }
  result.rmse_ratio = std::sqrt(sum_of(blocks.after) / std::max(sum_of(blocks.before), 1e-300));
  double mean = 0.0;
  std::vector<double> differences;
  for (std::size_t b = 0; b < blocks.before.size(); ++b) {
    differences.push_back(blocks.before[b] - blocks.after[b]);
    mean += differences.back() / count;
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

bool is_rounding(double rmse, const Signals& signals) {
  constexpr double kRounding = 1e-9;  // of the output's deviation; doubles passed through a fit
  return rmse < kRounding * signals.output().deviation;
}

bool by_rmse(const Trial& a, const Trial& b) { return a.rmse < b.rmse; }

bool passes_over_samples(const Trial& trial) {
  return acts_at(trial.model.effects.back(), Stage::kWeight);
}

bool ties_with(const Trial& other, const Trial& best, double current_rmse,
               const SearchOptions& options) {
  if (compared(other.held_out, best.held_out).t < 1.0) return true;
  const auto gain = [&](const Trial& trial) {
    return current_rmse * current_rmse - trial.rmse * trial.rmse;
  };
  return other.rmse <= (1.0 + options.tie) * best.rmse &&
         gain(other) >= options.tied_gain * gain(best);
}

bool is_by_chance(const Trial& trial) { return trial.surrogate_p > kSurrogateSignificance; }

std::size_t chosen_of(const std::vector<Trial>& tried, double current_rmse,
                      const SearchOptions& options,
                      const std::function<bool(const Trial&)>& worth_adding) {
  constexpr double kDistinguished = 2.0;  // [standard errors]
  const Trial& best = *std::ranges::min_element(tried, {}, schwarz);
  const auto own = static_cast<std::size_t>(&best - tried.data());
  std::vector<std::size_t> ties{own};
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (i == own || !std::isfinite(tried[i].rmse) || is_by_chance(tried[i])) continue;
    if (ties_with(tried[i], best, current_rmse, options)) ties.push_back(i);
  }
  const auto numbers = [&](std::size_t i) { return complexity(tried[i].model); };
  const std::size_t fewest = numbers(*std::ranges::min_element(ties, {}, numbers));
  std::erase_if(ties, [&](std::size_t i) { return numbers(i) != fewest; });
  const std::size_t least =
      *std::ranges::min_element(ties, {}, [&](std::size_t i) { return tried[i].rmse; });
  if (worth_adding && !worth_adding(tried[least])) return least;
  // Rounding decides where their fits end: the blocks do not distinguish these, so the list does.
  std::erase_if(ties, [&](std::size_t i) {
    return i != least && (compared(tried[i].held_out, tried[least].held_out).t >= kDistinguished ||
                          (worth_adding && !worth_adding(tried[i])));
  });
  return *std::ranges::min_element(ties, {}, [&](std::size_t i) {
    return std::pair(place_of(tried[i].model.effects.back().kind), tried[i].rmse);
  });
}

bool is_worth_adding(const Trial& trial, const HeldOut& current, double least_fall,
                     std::size_t candidates, const SearchOptions& options) {
  if (is_by_chance(trial)) return false;
  const Comparison comparison = compared(current, trial.held_out);
  // Bursts lie in few blocks, too few for the signs; that they stand out has been tested already.
  if (passes_over_samples(trial)) return 1.0 - comparison.rmse_ratio > options.large_fall;
  if (shows_in_rows(trial)) return 1.0 - comparison.rmse_ratio > least_fall;
  return worth_it(comparison, options, least_fall, candidates);
}

std::size_t added_of(const std::vector<Trial>& tried, const HeldOut& current, double least_fall,
                     std::size_t candidates, const SearchOptions& options) {
  const auto worth_adding = [&](const Trial& trial) {
    return is_worth_adding(trial, current, least_fall, candidates, options);
  };
  const std::size_t chosen = chosen_of(tried, current.rmse(), options, worth_adding);
  if (worth_adding(tried[chosen])) return chosen;
  // What the rows show is there, whatever chance may have made of the blocks.
  const auto shown = std::ranges::find_if(tried, [&](const Trial& trial) {
    return std::isfinite(trial.rmse) && shows_in_rows(trial) && worth_adding(trial);
  });
  return static_cast<std::size_t>(shown - tried.begin());
}

std::vector<std::string> tied_kinds(const std::vector<Trial>& tried, std::size_t chosen,
                                    double current_rmse, const SearchOptions& options) {
  std::vector<std::string> kinds;
  const std::string& own = tried[chosen].model.effects.back().kind;
  for (const Trial& trial : tried) {
    if (!std::isfinite(trial.rmse) || is_by_chance(trial)) continue;
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

}  // namespace stillhand::diagnosis
