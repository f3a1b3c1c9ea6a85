// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/trials.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "services/core/diagnosis/fitting/cascade.hpp"
#include "services/core/diagnosis/fitting/screening.hpp"
#include "services/core/diagnosis/fitting/shape_exchange.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/stability.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kNear = 1.35;  // of the best error: worth fitting to the end

// What a round screens on.
struct Part {
  Part(const Signals& all, const RoundSettings& settings)
      : is_whole(all.size() <= kMostScreened),
        signals(screened_part(all)),
        blocks(is_whole ? settings.blocks : make_blocks(signals)) {}

  bool is_whole;
  Signals signals;
  Blocks blocks;
};

}  // namespace

Trial judged_trial(Model model, const Signals& signals, const Blocks& blocks, int iterations,
                   bool refitting) {
  Trial trial;
  FitOptions options;
  options.max_iterations = iterations;
  options.relative_tolerance = 1e-8;
  options.grams_at_end = true;
  const FitResult fitted = fit(model, signals, blocks, options);
  if (refitting) {
    trial.held_out = held_out(model, signals, blocks, fitted.grams ? &*fitted.grams : nullptr);
  } else if (fitted.grams) {
    trial.held_out = held_out_linearised(*fitted.grams, blocks);
  }
  trial.rmse =
      trial.held_out.finite ? trial.held_out.rmse() : std::numeric_limits<double>::infinity();
  trial.model = std::move(model);
  return trial;
}

namespace {

Trial judged(const RoundSettings& settings, Model model, const Signals& signals,
             const Blocks& blocks, int iterations, bool refitting) {
  Trial trial = judged_trial(std::move(model), signals, blocks, iterations, refitting);
  if (settings.rising_springs && turns_round(trial.model, signals)) {
    trial.rmse = std::numeric_limits<double>::infinity();
  }
  return trial;
}

bool same_shape(const Model& a, const Model& b) {
  return a.effects.back().kind == b.effects.back().kind &&
         a.effects.back().form == b.effects.back().form;
}

// The first effect may have hidden poles of a body whose order was reduced, or stand between two
// bodies whose poles are more than one has: one pole more, and another, while that explains more of
// what is screened.
void lift_on_part(Trial& best, const Part& part, const Signals& signals,
                  const RoundSettings& settings) {
  constexpr double kWorthPoles = 0.99;       // of the held-out error
  constexpr int kMorePoles = 2;              // than the body was asked for: those of a second one
  constexpr double kRowsForANumber = 100.0;  // as of a noise model, Eq. DG-61
  const double rows = sum_of(part.signals.weight());
  const int iterations = settings.options.fit_iterations;
  if (passes_through_body(best.model)) return;
  Trial richest =
      part.is_whole ? best : judged(settings, best.model, part.signals, part.blocks, 1, false);
  const std::size_t own = best.model.body.order();
  while (static_cast<int>(richest.model.body.order()) < settings.order + kMorePoles) {
    Model more = lifted(richest.model);
    const bool is_asked_for = static_cast<int>(more.body.order()) <= settings.order;
    if (!is_asked_for && rows < kRowsForANumber * static_cast<double>(complexity(more))) break;
    Trial richer =
        judged(settings, std::move(more), part.signals, part.blocks, iterations, part.is_whole);
    if (!(richer.rmse < kWorthPoles * richest.rmse)) break;
    richest = std::move(richer);
  }
  if (richest.model.body.order() == own) return;
  if (!part.is_whole) {
    richest =
        judged(settings, std::move(richest.model), signals, settings.blocks, iterations, true);
    if (!(richest.rmse < kWorthPoles * best.rmse)) return;
  }
  best = std::move(richest);
}

// Nonlinearities inside the body differ in their shape alone, and their fits often end in a local
// minimum.  Each is tried again from the linear parts of the best of them, and from those of
// another that this has made the best.
void exchange_shapes(std::vector<Trial>& all, double current_rmse, const Signals& signals,
                     const RoundSettings& settings) {
  constexpr double kGains = 0.97;  // of the present error
  constexpr int kPasses = 2;
  const SearchOptions& options = settings.options;
  const Part part(signals, settings);
  const auto inside = [](const Trial& trial) { return ends_inside_body(trial.model); };
  for (int pass = 0; pass < kPasses; ++pass) {
    const auto best = std::ranges::find_if(all, inside);
    if (best == all.end() || best->rmse > kGains * current_rmse) return;
    lift_on_part(*best, part, signals, settings);
    const Model from = best->model;
    const double best_rmse = part.is_whole
                                 ? best->rmse
                                 : judged(settings, from, part.signals, part.blocks, 1, false).rmse;
    settings.for_each(all.size(), [&](std::size_t i) {
      if (!inside(all[i]) || &all[i] == &*best) return;
      const auto start = with_shape_of(all[i].model.effects.back(), from, signals);
      if (!start) return;
      Trial other =
          judged(settings, *start, part.signals, part.blocks, options.screening_iterations, false);
      if (!(other.rmse < kNear * best_rmse) || (part.is_whole && other.rmse >= all[i].rmse)) return;
      other = judged(settings, std::move(other.model), signals, settings.blocks,
                     options.fit_iterations, true);
      if (other.rmse < all[i].rmse) all[i] = std::move(other);
    });
    std::ranges::stable_sort(all, by_rmse);
    if (same_shape(std::ranges::find_if(all, inside)->model, from)) return;
  }
}

}  // namespace

void start_afresh(Model& model, const Signals& signals, int order) {
  constexpr double kWorthPoles = 0.98;  // of the squared error
  std::vector<double> left = signals.output().values;
  std::vector<std::vector<double>> inputs;
  if (!without_effects(model, signals, inputs, left)) return;
  FreeRun run;
  double least = residual_of(model, signals, run).squaredNorm();
  const auto own = static_cast<int>(model.body.order());
  for (const int p : {own, order}) {
    if (p > own && passes_through_body(model)) break;
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

namespace {

constexpr std::size_t kFewest = 5;  // the order among them by a few steps is not that at the end

// A term or a gain that the columns next to the model do not show: its fit would hardly gain more.
bool is_hopeless(const Proposal& proposal) {
  constexpr double kLeastGain = 0.0025;  // of the squared error; DG-17 asks for four times as much
  if (proposal.body) return false;
  const Stage stage = effect_kind(proposal.effect.kind).stage(proposal.effect);
  return (stage == Stage::kTerm || stage == Stage::kGain) && proposal.gain < kLeastGain;
}

Trial not_fitted(Model model) {
  Trial trial;
  trial.fitted = false;
  trial.rmse = std::numeric_limits<double>::infinity();
  trial.model = std::move(model);
  return trial;
}

// To pass over samples explains nothing: only where no effect explains much.
void drop_bursts(std::vector<Trial>& all, double current_rmse) {
  constexpr double kExplainsMuch = 0.85;
  const auto explains = std::ranges::find_if_not(all, passes_over_samples);
  if (explains != all.end() && explains->rmse < kExplainsMuch * current_rmse) {
    std::erase_if(all, passes_over_samples);
  }
}

// Where nothing gains, a few are carried to the end all the same: some begin slowly.
std::size_t near_the_best(const std::vector<Trial>& all, double current_rmse) {
  constexpr double kGains = 0.985;
  std::size_t near = 0;
  while (near < all.size() && all[near].rmse < kNear * all.front().rmse &&
         (near < kFewest || all[near].rmse < kGains * current_rmse)) {
    ++near;
  }
  return near;
}

// Of those that were fitted to the end on pieces: the best, and what may tie with it (twice
// SearchOptions::tie) and gains as much as a first effect must.
std::size_t worth_all_samples(const std::vector<Trial>& all, double current_rmse,
                              const SearchOptions& options) {
  std::size_t near = 1;
  while (near < all.size() && all[near].rmse < (1.0 + 2.0 * options.tie) * all.front().rmse &&
         all[near].rmse < (1.0 - options.first_least_fall) * current_rmse) {
    ++near;
  }
  return std::min(near, all.size());
}

// The first of them fitted to the end and judged by the linearisation alone.
void fit_on_part(Screened& screened, std::size_t count, const Part& part,
                 const RoundSettings& settings) {
  auto& all = screened.trials;
  settings.for_each(count, [&](std::size_t i) {
    const bool own_body = all[i].own_body;
    if (i < kFewest && !screened.first_fitted) {
      start_afresh(all[i].model, part.signals, settings.order);
    }
    all[i] = judged(settings, std::move(all[i].model), part.signals, part.blocks,
                    settings.options.fit_iterations, false);
    all[i].own_body = own_body;
  });
  std::ranges::stable_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), by_rmse);
}

}  // namespace

Signals screened_part(const Signals& signals) {
  constexpr std::size_t kPieces = 10;
  if (signals.size() <= kMostScreened) return signals;
  const std::vector<Stretch> pieces =
      spread_pieces(signals.stretches(), kPieces, kMostScreened, signals.rate_hz());
  // Pieces of many short stretches may hold too little.
  std::size_t rows = 0;
  for (const Stretch& piece : pieces) rows += piece.end - piece.first;
  return rows < kMostScreened / 2 ? signals : signals.cut_to(pieces);
}

Screened screened_trials(const Model& current, double current_rmse, const Signals& signals,
                         const RoundSettings& settings, Shapes shapes,
                         std::vector<Proposal> known) {
  const Part part(signals, settings);
  const Screening screening(current, part.signals, part.blocks, settings.impulse_response,
                            std::move(known));
  std::vector<const EffectKind*> kinds;
  std::ranges::copy_if(effect_kinds(), std::back_inserter(kinds), [&](const EffectKind* kind) {
    return kind->any_shape() == (shapes == Shapes::kAny);
  });
  std::vector<std::vector<Proposal>> of_kinds(kinds.size());
  settings.for_each(kinds.size(),
                    [&](std::size_t k) { of_kinds[k] = kinds[k]->proposed(screening); });
  std::vector<Proposal> proposals;
  for (auto& of_kind : of_kinds) std::ranges::move(of_kind, std::back_inserter(proposals));
  std::vector<Trial> all(proposals.size());
  settings.for_each(proposals.size(), [&](std::size_t i) {
    Model model = current;
    if (proposals[i].body) model.body = *proposals[i].body;
    model.effects.push_back(proposals[i].effect);
    all[i] = is_hopeless(proposals[i])
                 ? not_fitted(std::move(model))
                 : judged(settings, std::move(model), part.signals, part.blocks,
                          settings.options.screening_iterations, false);
    all[i].own_body = proposals[i].body.has_value();
  });
  std::ranges::stable_sort(all, by_rmse);
  if (!part.is_whole) current_rmse = held_out(current, part.signals, part.blocks).rmse();
  const std::size_t near = near_the_best(all, current_rmse);
  return {std::move(all), current_rmse, near};
}

void fit_first(Screened& screened, const Signals& signals, const RoundSettings& settings) {
  fit_on_part(screened, std::min(screened.near, kFewest), Part(signals, settings), settings);
  drop_bursts(screened.trials, screened.current_rmse);
  screened.near = std::min(screened.near, screened.trials.size());
  screened.first_fitted = true;
}

std::vector<Trial> finished_trials(Screened screened, double current_rmse, const Signals& signals,
                                   const RoundSettings& settings) {
  auto& all = screened.trials;
  if (const Part part(signals, settings); !part.is_whole) {
    fit_on_part(screened, screened.near, part, settings);
    screened.near = worth_all_samples(all, screened.current_rmse, settings.options);
    std::for_each(all.begin() + static_cast<std::ptrdiff_t>(screened.near), all.end(),
                  [](Trial& trial) { trial = not_fitted(std::move(trial.model)); });
  } else if (!screened.first_fitted) {
    settings.for_each(std::min(screened.near, kFewest),
                      [&](std::size_t i) { start_afresh(all[i].model, signals, settings.order); });
  }
  settings.for_each(screened.near, [&](std::size_t i) {
    all[i] = judged(settings, std::move(all[i].model), signals, settings.blocks,
                    settings.options.fit_iterations, true);
  });
  std::ranges::stable_sort(all, by_rmse);
  exchange_shapes(all, current_rmse, signals, settings);
  drop_bursts(all, current_rmse);
  return std::move(all);
}

namespace {

// The best fit of a curve that begins as the law's own, in its linear parts or between two bodies.
std::optional<Trial> curve_after(const Trial& law, const Part& part, const Signals& signals,
                                 const RoundSettings& settings) {
  const FreeRun run = free_run(law.model, signals);
  const auto drawn_by = [&](const EffectKind* kind) {
    return kind->drawn_after(run.argument, run.phi, run.weight);
  };
  const auto drawer = std::ranges::find_if(
      effect_kinds(), [&](const EffectKind* kind) { return drawn_by(kind).has_value(); });
  if (drawer == effect_kinds().end()) return {};
  std::vector<Model> starts;
  const auto add = [&starts](std::optional<Model> start) {
    if (start) starts.push_back(*std::move(start));
  };
  add(with_shape_of(*drawn_by(*drawer), law.model, signals));
  // More poles than the body was asked for (DG-49): those of a second one?
  if (static_cast<int>(law.model.body.order()) > settings.order && law.model.effects.size() == 1) {
    add(cascade(law.model, **drawer, part.signals));
  }
  std::optional<Trial> best;
  for (Model& start : starts) {
    Trial trial = judged(settings, std::move(start), part.signals, part.blocks,
                         settings.options.fit_iterations, part.is_whole);
    if (std::isfinite(trial.rmse) && (!best || trial.rmse < best->rmse)) best = std::move(trial);
  }
  return best;
}

// With the law whose shape is the curve's, if one of those that were tried has it.
std::optional<Model> read_by_law(const Model& curve, const std::vector<Trial>& tried,
                                 const Signals& signals) {
  Reading best{0.1, {}};  // of the curve's bend
  for (const Trial& law : tried) {
    if (!ends_inside_body(law.model)) continue;
    Reading reading = read_as(law.model.effects.back(), curve, signals);
    if (reading.model && reading.unread < best.unread) best = std::move(reading);
  }
  return std::move(best.model);
}

}  // namespace

std::optional<Trial> curve_in_place(const Trial& law, const std::vector<Trial>& tried,
                                    double current_rmse, const Signals& signals,
                                    const RoundSettings& settings) {
  if (!ends_inside_body(law.model)) return {};
  const Part part(signals, settings);
  std::optional<Trial> curve = curve_after(law, part, signals, settings);
  if (!curve) return {};
  const auto ended = [&](const Model& model) {
    return judged(settings, model, signals, settings.blocks, settings.options.fit_iterations, true);
  };
  const std::optional<Model> read = read_by_law(curve->model, tried, part.signals);
  if (!part.is_whole) curve = ended(curve->model);
  if (!read) return curve;
  Trial named = ended(*read);
  const auto gain = [&](const Trial& trial) {
    return current_rmse * current_rmse - trial.rmse * trial.rmse;
  };
  return gain(named) >= settings.options.tied_gain * gain(*curve) ? std::move(named) : curve;
}

std::vector<Proposal> with_own_bodies(const std::vector<Trial>& trials) {
  std::vector<Proposal> proposals;
  for (const Trial& trial : trials) {
    if (!trial.own_body || !std::isfinite(trial.rmse)) continue;
    proposals.push_back({trial.model.effects.back(), 0.0, trial.model.body});
  }
  return proposals;
}

void in_order(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t i = 0; i < count; ++i) task(i);
}

}  // namespace stillhand::diagnosis
