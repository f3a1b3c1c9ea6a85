// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/judging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/core/diagnosis/effect_sizes.hpp"
#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "services/core/diagnosis/no_model.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::diagnosis {
namespace {

// Half of the 95 % interval of the blocks' mean, Student's t.
double half_width(const std::vector<double>& of_blocks) {
  const auto count = static_cast<double>(of_blocks.size());
  const double mean = std::accumulate(of_blocks.begin(), of_blocks.end(), 0.0) / count;
  double square = 0.0;
  for (const double each : of_blocks) square += (each - mean) * (each - mean);
  const double standard_error = std::sqrt(square / (count - 1.0) / count);
  return statistics::t_quantile(0.975, count - 1.0) * standard_error;
}

HeldOutError held_out_error(const HeldOut& held_out, double variance) {
  HeldOutError error;
  std::vector<double> squares;
  for (std::size_t b = 0; b < held_out.squares.size(); ++b) {
    if (held_out.weights[b] >= 1.0) squares.push_back(held_out.squares[b] / held_out.weights[b]);
  }
  error.rmse = held_out.rmse();
  const double half = half_width(squares);
  error.low = std::sqrt(std::max(error.rmse * error.rmse - half, 0.0));
  error.high = std::sqrt(error.rmse * error.rmse + half);
  error.vaf_percent = 100.0 * (1.0 - error.rmse * error.rmse / std::max(variance, 1e-300));
  return error;
}

// Eq. DG-76.
Explained explained_by(const HeldOut& before, const HeldOut& after) {
  std::vector<double> falls;
  for (std::size_t b = 0; b < before.squares.size(); ++b) {
    if (before.weights[b] < 1.0 || after.weights[b] < 1.0) continue;
    falls.push_back(before.squares[b] / before.weights[b] - after.squares[b] / after.weights[b]);
  }
  const double fall = before.rmse() * before.rmse() - after.rmse() * after.rmse();
  const double half = half_width(falls);
  const auto root = [](double square) { return std::sqrt(std::max(square, 0.0)); };
  return {root(fall), root(fall - half), root(fall + half)};
}

std::string measured_channel(const Effect& effect, const Signals& signals,
                             const std::vector<std::string>& inputs) {
  // Of several channels, the one that is not an input.
  std::string channel;
  for (const std::string& name : effect.channels) {
    const std::string source = signals.at(name).source;
    const bool is_input = std::ranges::find(inputs, source) != inputs.end();
    if (channel.empty() || !is_input) channel = source;
    if (!is_input) break;
  }
  return channel;
}

// The search judges behind a noise model, which hardly counts what is slow, and the model of the
// verdict is fitted without it: if fewer of the effects leave as little, the later ones leave.
void keep_what_helps(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks) {
  const Model found = diagnosis.model;
  if (found.effects.empty()) return;
  double least = held_out(found, signals, blocks).rmse();
  for (std::size_t count = found.effects.size(); count-- > 0;) {
    Model fewer = found;
    fewer.effects.resize(count);
    if (count == 0) {
      fewer = diagnosis.baseline.model;
    } else {
      fit(fewer, signals, blocks);
    }
    const double error = held_out(fewer, signals, blocks).rmse();
    if (!(error <= least)) continue;
    least = error;
    auto& additions = diagnosis.search.additions;
    diagnosis.search.removed += additions.size() - count;
    additions.resize(count);
    diagnosis.model = std::move(fewer);
  }
}

// The verdict has the effects of the search, in its order.
bool as_searched(const SearchResult& search) { return search.removed == 0 && !search.reordered; }

// Errors of the models with the first effect, the first two, and so on.
std::vector<HeldOut> chain(const Diagnosis& diagnosis, const Signals& signals,
                           const Blocks& blocks) {
  const auto& additions = diagnosis.search.additions;
  std::vector<HeldOut> errors{held_out(diagnosis.baseline.model, signals, blocks)};
  for (std::size_t e = 0; e < additions.size(); ++e) {
    if (as_searched(diagnosis.search)) {
      errors.push_back(additions[e].after);
      continue;
    }
    // The body next to all effects may be in a local minimum for fewer.
    HeldOut least;
    for (const Body& body : {diagnosis.model.body, diagnosis.baseline.model.body}) {
      if (body.order() != diagnosis.model.body.order()) continue;
      Model model = diagnosis.model;
      model.body = body;
      model.effects.resize(e + 1);
      fit(model, signals, blocks, {});
      HeldOut error = held_out(model, signals, blocks);
      if (least.squares.empty() || error.rmse() < least.rmse()) least = std::move(error);
    }
    errors.push_back(std::move(least));
  }
  return errors;
}

// An effect with which the error grows stays only if another one needs it, and then stands behind
// it: so the error of the verdict falls with each effect.
void put_in_order(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks) {
  auto& additions = diagnosis.search.additions;
  const double least = held_out(diagnosis.model, signals, blocks).rmse();
  for (std::size_t e = additions.size(); e-- > 0 && additions.size() > 1;) {
    const std::vector<HeldOut> errors = chain(diagnosis, signals, blocks);
    if (errors[e + 1].rmse() < errors[e].rmse()) continue;
    Model fewer = diagnosis.model;
    const auto place = static_cast<std::ptrdiff_t>(e);
    fewer.effects.erase(fewer.effects.begin() + place);
    fit(fewer, signals, blocks);
    if (held_out(fewer, signals, blocks).rmse() <= least) {
      ++diagnosis.search.removed;
      additions.erase(additions.begin() + place);
      diagnosis.model = std::move(fewer);
    } else if (e + 1 < additions.size()) {
      diagnosis.search.reordered = true;
      std::swap(additions[e], additions[e + 1]);
      std::swap(diagnosis.model.effects[e], diagnosis.model.effects[e + 1]);
    }
  }
}

void add_effects(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks,
                 double variance) {
  const std::vector<HeldOut> errors = chain(diagnosis, signals, blocks);
  diagnosis.baseline_error = held_out_error(errors.front(), variance);
  for (std::size_t e = 0; e < diagnosis.model.effects.size(); ++e) {
    const Effect& effect = diagnosis.model.effects[e];
    FoundEffect found;
    found.effect = effect;
    found.channel = measured_channel(effect, signals, diagnosis.options.inputs);
    found.before = held_out_error(errors[e], variance);
    found.after = held_out_error(errors[e + 1], variance);
    found.p = as_searched(diagnosis.search) ? diagnosis.search.additions[e].comparison.p
                                            : compared(errors[e], errors[e + 1]).p;
    found.evidence = effect_kind(effect.kind).evidence(effect);
    found.ties = diagnosis.search.additions[e].ties;
    found.explained = explained_by(errors[e], errors[e + 1]);
    found.counts =
        diagnosis.output_unit != "N" || found.explained.rms >= diagnosis.options.least_force_n;
    diagnosis.effects.push_back(std::move(found));
  }
  diagnosis.final_error = held_out_error(errors.back(), variance);
}

// Effects of channels that do not belong together name nothing.
void drop_effects(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks,
                  double variance) {
  if (diagnosis.effects.empty()) return;
  diagnosis.effects.clear();
  diagnosis.model = diagnosis.baseline.model;
  diagnosis.search = {
      diagnosis.model, {}, 0, false, false, {}, {}, std::move(diagnosis.search.last_tried), {}};
  add_effects(diagnosis, signals, blocks, variance);
}

// A note for each kind that a recording held out whole has refuted.
void note_refuted(Diagnosis& diagnosis) {
  std::vector<std::string> noted;
  for (const RefutedEffect& refuted : diagnosis.search.refuted) {
    const std::string& kind = refuted.effect.kind;
    const auto is_kind = [&](const Effect& effect) { return effect.kind == kind; };
    if (std::ranges::any_of(diagnosis.model.effects, is_kind) ||
        std::ranges::find(noted, kind) != noted.end()) {
      continue;
    }
    noted.push_back(kind);
    std::string note = kind + " (" + refuted.effect.form +
                       ") left out: it changes the error of recordings held out whole, ";
    for (std::size_t r = 0; r < refuted.fall.size(); ++r) {
      note += fmt::format("{}{} by {:+.1f} %", r == 0 ? "" : ", ", r + 1, -100.0 * refuted.fall[r]);
    }
    diagnosis.notes.push_back(note);
  }
}

// A note for each that was worth adding but for surrogates, and that no other round added.
void note_by_chance(Diagnosis& diagnosis) {
  std::vector<Effect> noted = diagnosis.model.effects;
  for (const EffectByChance& each : diagnosis.search.by_chance) {
    const auto is_alike = [&](const Effect& other) {
      return other.kind == each.effect.kind && other.form == each.effect.form &&
             other.channels == each.effect.channels;
    };
    if (std::ranges::any_of(noted, is_alike)) continue;
    noted.push_back(each.effect);
    const double reached = each.p * (1.0 + kSurrogates) - 1.0;
    diagnosis.notes.push_back(fmt::format(
        "{} ({}) left out: it lowers the error by {:.1f} %, but in {:.0f} of {} copies of what the "
        "model leaves, moved in time or with other phases, something explains as much",
        each.effect.kind, each.effect.form, 100.0 * each.fall, reached,
        static_cast<int>(kSurrogates)));
  }
}

// An effect of a slow channel that could be one of time, Eq. DG-59, ties with the best of those
// that were tried with it.
void tie_with_time(FoundEffect& found, const Addition& addition) {
  for (const Trial& trial : addition.tried) {
    const Effect& effect = trial.model.effects.back();
    if (!std::isfinite(trial.rmse) || passes_over_samples(trial)) continue;
    if (!effect_kind(effect.kind).time_only(effect)) continue;
    if (std::ranges::find(found.ties, effect.kind) == found.ties.end()) {
      found.ties.push_back(effect.kind);
    }
    return;
  }
}

void add_ties_with_time(Diagnosis& diagnosis) {
  for (const LeftOut& each : diagnosis.carried.left_out) {
    if (!each.like_time) continue;
    for (std::size_t e = 0; e < diagnosis.effects.size(); ++e) {
      if (is_same(diagnosis.effects[e].effect, each.effect)) {
        tie_with_time(diagnosis.effects[e], diagnosis.search.additions[e]);
      }
    }
  }
}

// What the carried model keeps of each effect, and why not all of it.
void add_carried(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks,
                 double variance) {
  const CarriedModel& carried = diagnosis.carried;
  auto next = carried.model.effects.begin();  // in the order in which they were found
  for (FoundEffect& found : diagnosis.effects) {
    if (next != carried.model.effects.end() && is_same(*next, found.effect)) {
      found.carried = next++->share;
    }
    if (found.carried > 0.0) {
      if (found.carried < 1.0) {
        found.why_not_carried = "the parts of the recording agree on this share alone";
      }
      continue;
    }
    for (const LeftOut& each : carried.left_out) {
      if (is_same(each.effect, found.effect)) found.why_not_carried = each.why;
    }
  }
  diagnosis.carried_error = held_out_error(held_out(carried.model, signals, blocks), variance);
  diagnosis.carried.model.heldout_rmse = diagnosis.carried_error.rmse;
  diagnosis.baseline.model.heldout_rmse = diagnosis.baseline_error.rmse;
}

void add_sizes(Diagnosis& diagnosis, const Signals& signals) {
  if (diagnosis.effects.empty()) return;
  const Linearisation line = linearised(diagnosis.model, signals);
  const NumberErrors errors(diagnosis.model, line, signals);
  for (std::size_t e = 0; e < diagnosis.effects.size(); ++e) {
    diagnosis.effects[e].sizes =
        effect_sizes(size_case(diagnosis.model, e, signals, line.run), errors);
  }
}

// Of the last round.
std::size_t last_candidates(const SearchResult& search) {
  if (!search.last_tried.empty() || search.additions.empty()) return search.last_tried.size();
  return search.additions.back().tried.size();
}

void add_limits(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks) {
  const SearchOptions& options = diagnosis.options.search;
  FreeRun run;
  const Eigen::VectorXd residual = residual_of(diagnosis.model, signals, run);
  const Signals whitened =
      signals.whitened(run.finite ? whitening_taps(residual, signals) : std::vector<double>());
  diagnosis.limits =
      planted_limits(diagnosis.model, signals, whitened, blocks,
                     {last_candidates(diagnosis.search),
                      diagnosis.effects.empty() ? options.first_least_fall : options.least_fall},
                     options, diagnosis.options.for_each);
  diagnosis.detection_limit = typical_limit(diagnosis.limits);
}

void note_derived(Diagnosis& diagnosis, const Signals& signals) {
  for (const Signal& signal : signals.all()) {
    if (!signal.derived) continue;
    const bool used = std::ranges::any_of(diagnosis.model.effects, [&](const Effect& effect) {
      return std::ranges::find(effect.channels, signal.name) != effect.channels.end();
    });
    if (used) diagnosis.notes.push_back("'" + signal.name + "' was made from " + signal.source);
  }
}

}  // namespace

Questions::Questions(const Signals& signals)
    : impulse_response(fit_impulse_response(signals)),
      excitation(periodic_excitation_of(signals)) {}

void take_found(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks) {
  diagnosis.model = diagnosis.search.model;
  if (diagnosis.search.whitened) fit(diagnosis.model, signals, blocks, {});
  keep_what_helps(diagnosis, signals, blocks);
}

void judge(Diagnosis& diagnosis, const Measurement& working, const Signals& signals,
           const Blocks& blocks) {
  put_in_order(diagnosis, signals, blocks);
  const double variance = signals.output().deviation * signals.output().deviation;
  add_effects(diagnosis, signals, blocks, variance);
  if (!diagnosis.no_model) {
    diagnosis.no_model =
        no_model_of(working, signals, blocks, diagnosis.model, diagnosis.final_error.rmse,
                    diagnosis.options.order, diagnosis.options.heaviest_kg);
    if (diagnosis.no_model) drop_effects(diagnosis, signals, blocks, variance);
  }
  add_sizes(diagnosis, signals);
  note_refuted(diagnosis);
  note_by_chance(diagnosis);
  std::vector<bool> counts;
  for (const FoundEffect& found : diagnosis.effects) counts.push_back(found.counts);
  diagnosis.carried =
      carried_model(diagnosis.model, diagnosis.baseline.model, signals, blocks, counts);
  add_ties_with_time(diagnosis);
  add_carried(diagnosis, signals, blocks, variance);
}

void look_at_the_rest(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks,
                      const Questions& questions) {
  const Screening screening(diagnosis.model, signals, blocks, questions.impulse_response);
  diagnosis.after = questions.of(screening);
  if (!is_rounding(diagnosis.final_error.rmse, signals)) {
    diagnosis.unexplained = unexplained_of(diagnosis.after, screening);
  }
  add_limits(diagnosis, signals, blocks);
  diagnosis.noise_floor = noise_floor_of(diagnosis.after, screening,
                                         {diagnosis.final_error.low, diagnosis.final_error.high,
                                          diagnosis.baseline.impulse_response_rmse});
  note_derived(diagnosis, signals);
}

}  // namespace stillhand::diagnosis
