// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/body_order.hpp"

#include <algorithm>
#include <utility>

#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/fitting/fit.hpp"
#include "services/core/diagnosis/trials.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kLongResponse = 0.98;  // a long response fits some noise, too: one per cent
constexpr double kBeyondLinear = 0.9;  // below it no body without the bend gets, whatever its order
constexpr int kHighestTried = 8;       // more modes than a body has within the band of a ride

// Memoryless or with memory, of what passes from input to output.
bool bends(const Effect& effect) {
  const Stage stage = effect_kind(effect.kind).stage(effect);
  return stage == Stage::kInputValue || stage == Stage::kFeedback || stage == Stage::kOutputValue;
}

Model of_order(int order, Model rest, const Signals& signals, const Blocks& blocks) {
  rest.body = fit_baseline(signals, blocks, order).model.body;
  if (rest.effects.empty()) return rest;
  start_afresh(rest, signals, order);
  fit(rest, signals, blocks, {});
  return rest;
}

}  // namespace

bool outdoes(const HeldOut& bent, const HeldOut& straight, const SearchOptions& options) {
  const Comparison comparison = compared(straight, bent);
  return 1.0 - comparison.rmse_ratio > options.first_least_fall &&
         comparison.p < options.large_significance;
}

std::optional<int> order_instead(const Model& model, const Signals& signals, const Blocks& blocks,
                                 int order, double impulse_response_rmse,
                                 const SearchOptions& options) {
  if (order < 1 || options.most_effects == 0 || signals.slow_poles()) return std::nullopt;
  Model rest = model;
  const bool bent = std::erase_if(rest.effects, bends) > 0;
  if (passes_through_body(rest)) return std::nullopt;
  const Signals part = screened_part(signals);
  const Blocks of_part = part.size() == signals.size() ? blocks : make_blocks(part);
  HeldOut least = held_out(model, part, of_part);
  if (!bent && !(impulse_response_rmse < kLongResponse * least.rmse())) return std::nullopt;
  if (bent && least.rmse() < kBeyondLinear * impulse_response_rmse) return std::nullopt;
  std::optional<int> taken;
  while (order < kHighestTried) {
    order = std::min(order + 2, kHighestTried);
    HeldOut next = held_out(of_order(order, rest, part, of_part), part, of_part);
    // Between bodies cross-validation alone decides: a mode more or less is no verdict.
    const bool better = bent && !taken ? !outdoes(least, next, options)
                                       : next.rmse() < (1.0 - options.least_fall) * least.rmse();
    if (!better) continue;
    taken = order;
    least = std::move(next);
  }
  return taken;
}

}  // namespace stillhand::diagnosis
