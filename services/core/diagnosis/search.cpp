// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "services/core/diagnosis/model/stability.hpp"
#include "services/core/diagnosis/recordings_out.hpp"
#include "services/core/diagnosis/surrogate_round.hpp"

namespace stillhand::diagnosis {
namespace {

bool has_any_shape(const Trial& trial) {
  return effect_kind(trial.model.effects.back().kind).any_shape();
}

// Effects of time alone describe one recording and cannot be tested on another.
bool asks_recordings(const Trial& trial) {
  const Effect& effect = trial.model.effects.back();
  return !passes_over_samples(trial) && !effect_kind(effect.kind).time_only(effect);
}

// Drops effects that the later ones have made idle.  True when one left.  Of a long record one that
// is needed on the pieces stays without a fit to all samples.
bool retest(SearchResult& result, const Signals& signals, const Blocks& blocks,
            const SearchOptions& options) {
  if (result.model.effects.size() < 2) return false;
  const Signals part = screened_part(signals);
  const Blocks part_blocks = make_blocks(part);
  const bool is_whole = part.size() == signals.size();
  const HeldOut with_on_part = is_whole ? HeldOut() : held_out(result.model, part, part_blocks);
  const HeldOut with = held_out(result.model, signals, blocks);
  const auto needed = [&](const HeldOut& without, const HeldOut& whole) {
    return !without.finite || worth_it(compared(without, whole), options, options.least_fall, 1);
  };
  for (std::size_t e = 0; e + 1 < result.model.effects.size(); ++e) {
    const Effect& effect = result.model.effects[e];
    const EffectKind& kind = effect_kind(effect.kind);
    if (kind.stage(effect) == Stage::kWeight || kind.shows_in_rows(effect)) continue;
    Model without = result.model;
    without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(e));
    if (!is_whole &&
        needed(judged_trial(without, part, part_blocks, options.fit_iterations, true).held_out,
               with_on_part)) {
      continue;
    }
    const Trial trial =
        judged_trial(std::move(without), signals, blocks, options.fit_iterations, true);
    if (needed(trial.held_out, with)) continue;
    result.model = trial.model;
    result.additions.erase(result.additions.begin() + static_cast<std::ptrdiff_t>(e));
    return true;
  }
  return false;
}

// In any order.
bool same_effects(const Model& a, const Model& b) {
  return std::ranges::is_permutation(a.effects, b.effects, is_same);
}

// The forward selection, from the baseline alone or with bursts left out from the start.
class Forward {
 public:
  Forward(const Forward&) = delete;
  Forward& operator=(const Forward&) = delete;
  Forward(const Baseline& baseline, const Signals& signals, const Blocks& blocks,
          const SearchOptions& options, const ForEach& for_each,
          const std::function<bool(const std::string&)>& progress, bool rising_springs)
      : baseline_(baseline),
        signals_(signals),
        blocks_(blocks),
        options_(options),
        progress_(progress),
        impulse_response_(fit_impulse_response(screened_part(signals))),
        settings_{blocks, impulse_response_, baseline.order, options, for_each, rising_springs} {}

  [[nodiscard]] SearchResult from_baseline() const {
    SearchResult result;
    result.model = baseline_.model;
    extend(result);
    return result;
  }

  // Bursts that show only once another effect is in the model were in every comparison that chose
  // that effect, and may have chosen it.
  [[nodiscard]] SearchResult without_bursts(const Effect& bursts) const {
    SearchResult result;
    const HeldOut before = held_out(baseline_.model, signals_, blocks_);
    result.model = baseline_.model;
    result.model.effects.push_back(bursts);
    Trial trial = judged_trial(result.model, signals_, blocks_, options_.fit_iterations, true);
    if (!trial.held_out.finite) return result;
    result.model = trial.model;
    const HeldOut after = trial.held_out;
    result.additions.push_back(
        {before, after, before, compared(before, after), {std::move(trial)}, 0, {}});
    extend(result);
    return result;
  }

 private:
  // Judged behind a filter that makes this model's residual white, Eq. DG-61.
  [[nodiscard]] Signals judged_by(const Model& model) const {
    FreeRun run;
    const Eigen::VectorXd residual = residual_of(model, signals_, run);
    return signals_.whitened(run.finite ? whitening_taps(residual, signals_)
                                        : std::vector<double>());
  }

  void extend(SearchResult& result) const {
    while (progress_("effect " + std::to_string(result.additions.size() + 1))) {
      Signals judged = signals_;
      if (!extended(result, judged)) return;
      if (retest(result, judged, blocks_, options_)) ++result.removed;
      if (result.removed > options_.most_effects) return;  // it goes in circles
      // A round that may add nothing would only say what else there is.
      if (result.additions.size() == options_.most_effects) return;
    }
  }

  // One round.  What is missing colours the residual too: noise is what the best candidate leaves.
  // Where that is coloured, the round is made again behind the filter, and the first one counts
  // only if nothing is worth adding there.
  // @param judged  gets the signals by which an effect was added
  bool extended(SearchResult& result, Signals& judged) const {
    if (result.whitened) fit(result.model, signals_, blocks_, refitting());
    const HeldOut current = held_out(result.model, signals_, blocks_);
    if (is_rounding(current.rmse(), signals_)) return false;
    Screened screened =
        screened_trials(result.model, current.rmse(), signals_, settings_, Shapes::kNamed);
    std::optional<SearchResult> behind;
    if (!screened.trials.empty() && std::isfinite(screened.trials.front().rmse)) {
      fit_first(screened, signals_, settings_);
      Signals whitened = judged_by(screened.trials.front().model);
      if (whitened.is_whitened() && result.additions.empty()) {
        whitened = judged_by(best_of_any_shape(screened.trials.front(), current.rmse()));
      }
      if (whitened.is_whitened()) {
        behind = refitted_behind(whitened, result);
        judged = std::move(whitened);
      }
    }
    if (behind) {
      if (extended_as_judged(*behind, judged, with_own_bodies(screened.trials), result)) {
        return true;
      }
      result.by_chance = behind->by_chance;
    }
    if (extend_by_one(result, current,
                      finished_trials(std::move(screened), current.rmse(), signals_, settings_),
                      signals_)) {
      judged = signals_;
      return true;
    }
    return extended_freely(behind ? *behind : result, judged, result);
  }

  // What a kind leaves of a shape that none has would be taken for the colour of noise.
  [[nodiscard]] Model best_of_any_shape(const Trial& named, double current_rmse) const {
    Screened shapes =
        screened_trials(baseline_.model, current_rmse, signals_, settings_, Shapes::kAny);
    if (shapes.trials.empty()) return named.model;
    fit_first(shapes, signals_, settings_);
    const Trial& shape = shapes.trials.front();
    return shape.rmse < (1.0 - options_.tie) * named.rmse ? shape.model : named.model;
  }

  [[nodiscard]] SearchResult refitted_behind(const Signals& whitened,
                                             const SearchResult& result) const {
    SearchResult other = result;
    if (other.model.effects.empty()) {
      other.model = fit_baseline(whitened, blocks_, baseline_.order).model;
    } else {
      fit(other.model, whitened, blocks_, refitting());
    }
    other.whitened = true;
    return other;
  }

  // @param known  of the round without the filter
  bool extended_as_judged(SearchResult& behind, const Signals& judged, std::vector<Proposal> known,
                          SearchResult& result) const {
    const HeldOut current = held_out(behind.model, judged, blocks_);
    Screened screened = screened_trials(behind.model, current.rmse(), judged, settings_,
                                        Shapes::kNamed, std::move(known));
    if (!extend_by_one(behind, current,
                       finished_trials(std::move(screened), current.rmse(), judged, settings_),
                       judged)) {
      return false;
    }
    result = std::move(behind);
    return true;
  }

  // No named kind is worth adding.  If a free form is, something is there; a named kind that
  // explains as much with fewer numbers is then added all the same.
  // @param from  after its round: `last_tried` holds the named ones as they were judged
  bool extended_freely(SearchResult from, const Signals& judged, SearchResult& result) const {
    // Next to a law it would take the law's numbers.
    if (options_.most_effects == 0 || !from.additions.empty()) return false;
    const HeldOut current = held_out(from.model, judged, blocks_);
    std::vector<Trial> tried = free_forms(from.model, current, judged);
    if (!confirmed(tried, current, options_.least_fall, judged, from)) {
      result.by_chance = std::move(from.by_chance);
      return false;
    }
    for (const Trial& named : from.last_tried) {
      if (std::isfinite(named.rmse) && !passes_over_samples(named) &&
          is_worth_adding(named, current, options_.least_fall, 1, options_)) {
        tried.push_back(named);
      }
    }
    std::ranges::stable_sort(tried, by_rmse);
    const std::size_t chosen = chosen_of(tried, current.rmse(), options_);
    if (!add(from, current, std::move(tried), chosen, judged, options_.least_fall)) return false;
    result = std::move(from);
    return true;
  }

  [[nodiscard]] static FitOptions refitting() {
    FitOptions options;
    options.max_iterations = 40;
    options.relative_tolerance = 1e-9;
    return options;
  }

  [[nodiscard]] std::vector<Trial> free_forms(const Model& model, const HeldOut& current,
                                              const Signals& judged) const {
    return finished_trials(screened_trials(model, current.rmse(), judged, settings_, Shapes::kAny),
                           current.rmse(), judged, settings_);
  }

  [[nodiscard]] bool extend_by_one(SearchResult& result, const HeldOut& current,
                                   std::vector<Trial> tried, const Signals& judged) const {
    const double least_fall =
        result.additions.empty() ? options_.first_least_fall : options_.least_fall;
    auto chosen = result.additions.size() == options_.most_effects
                      ? std::nullopt
                      : confirmed(tried, current, least_fall, judged, result);
    if (chosen && result.additions.empty()) {
      // A kind that fits a part of a shape, or bursts, which explain nothing, may hide it.
      const Trial& named = tried[*chosen];
      const double clearly_less = passes_over_samples(named)
                                      ? (1.0 - options_.large_fall) * current.rmse()
                                      : (1.0 - options_.tie) * named.rmse;
      std::vector<Trial> shapes = free_forms(result.model, current, judged);
      if (auto curve = curve_in_place(named, tried, current.rmse(), judged, settings_)) {
        shapes.push_back(*std::move(curve));
        std::ranges::stable_sort(shapes, by_rmse);
      }
      if (!shapes.empty() && shapes.front().rmse < clearly_less) {
        const auto shape = confirmed(shapes, current, options_.least_fall, judged, result);
        if (shape && shapes[*shape].rmse < clearly_less) {
          // Of a law with a curve's linear parts the named ones still are the rivals.
          const double error = shapes[*shape].rmse;
          if (!has_any_shape(shapes[*shape])) std::ranges::copy(tried, std::back_inserter(shapes));
          tried = std::move(shapes);
          std::ranges::stable_sort(tried, by_rmse);
          chosen = std::ranges::find(tried, error, &Trial::rmse) - tried.begin();
        }
      }
    }
    if (chosen && add(result, current, tried, *chosen, judged, least_fall)) return true;
    // Where the list has named another, the one with the least error may pass without the filter.
    if (chosen && *chosen != 0 &&
        is_worth_adding(tried.front(), current, least_fall, tried.size(), options_) &&
        !is_refused_by_surrogates(tried, 0, current, judged, result) &&
        add(result, current, tried, 0, judged, least_fall)) {
      return true;
    }
    if (!tried.empty() && std::isfinite(tried.front().rmse)) {
      result.last_tried = std::move(tried);
      result.last_current = current;
    }
    return false;
  }

  // Which of them is to be added, if any: the chosen one, unless surrogates of the residual give as
  // much, or one of the recordings that were joined refutes it; then the next.  Those that are
  // refuted leave `tried`.
  // @param result  of the rounds before; gets what is refused
  [[nodiscard]] std::optional<std::size_t> confirmed(std::vector<Trial>& tried,
                                                     const HeldOut& current, double least_fall,
                                                     const Signals& judged,
                                                     SearchResult& result) const {
    const RecordingsOut recordings(judged, blocks_);
    const std::size_t candidates = tried.size();
    std::vector<double> before;
    while (!tried.empty() && std::isfinite(tried.front().rmse)) {
      const std::size_t chosen = added_of(tried, current, least_fall, candidates, options_);
      if (chosen == tried.size()) break;
      if (is_refused_by_surrogates(tried, chosen, current, judged, result)) continue;
      const Trial& trial = tried[chosen];
      if (!recordings.several() || !asks_recordings(trial)) return chosen;
      if (before.empty()) before = recordings.errors(result.model);
      const std::vector<double> fall = falls(before, recordings.errors(trial.model));
      if (!refuted(fall, options_.least_fall)) return chosen;
      result.refuted.push_back({trial.model.effects.back(), fall});
      tried.erase(tried.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    return std::nullopt;
  }

  // Eq. DG-94: asks all of the round, if this one has to be asked and none has been.
  bool is_refused_by_surrogates(std::vector<Trial>& tried, std::size_t chosen,
                                const HeldOut& current, const Signals& judged,
                                SearchResult& result) const {
    const auto fall = [&](const Trial& trial) {
      return 1.0 - compared(current, trial.held_out).rmse_ratio;
    };
    const auto has_to_be_asked = [&](const Trial& trial) {
      return is_tested_by_surrogates(trial) && fall(trial) < options_.large_fall;
    };
    if (!has_to_be_asked(tried[chosen]) || tried[chosen].surrogate_p > 0.0) return false;
    const std::vector<double> p = surrogate_p_of(tried, result.model, judged, settings_);
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (std::isfinite(tried[i].rmse) && has_to_be_asked(tried[i])) tried[i].surrogate_p = p[i];
    }
    if (!is_by_chance(tried[chosen])) return false;
    result.by_chance.push_back(
        {tried[chosen].model.effects.back(), fall(tried[chosen]), p[chosen]});
    return true;
  }

  // Of the model as the verdict would have it.
  [[nodiscard]] HeldOut held_out_unfiltered(Model model) const {
    fit(model, signals_, blocks_, refitting());
    return held_out(model, signals_, blocks_);
  }

  // Behind a filter the error without it has to fall as well.
  bool add(SearchResult& result, const HeldOut& current, std::vector<Trial> tried,
           std::size_t chosen, const Signals& judged, double least_fall) const {
    HeldOut before = current;
    HeldOut after = tried[chosen].held_out;
    if (judged.is_whitened()) {
      before = held_out_unfiltered(result.model);
      after = held_out_unfiltered(tried[chosen].model);
      const double fall = std::min(least_fall, options_.large_fall);
      if (!(after.rmse() < (1.0 - fall) * before.rmse())) return false;
    }
    Addition addition{before,           after,  current, compared(current, tried[chosen].held_out),
                      std::move(tried), chosen, {}};
    addition.ties = tied_kinds(addition.tried, chosen, current.rmse(), options_);
    result.model = addition.tried[chosen].model;
    result.additions.push_back(std::move(addition));
    return true;
  }

  const Baseline& baseline_;
  const Signals& signals_;
  const Blocks& blocks_;
  const SearchOptions& options_;
  const std::function<bool(const std::string&)>& progress_;
  const ImpulseResponse impulse_response_;
  const RoundSettings settings_;
};

// The one with less error, or with fewer numbers if they tie, Eq. DG-50 and DG-17.
// @param without_any  [unit of the output] held-out error without what they found
const SearchResult& better_of(const SearchResult& one, const SearchResult& other,
                              double without_any, const Signals& signals, const Blocks& blocks,
                              const SearchOptions& options) {
  const auto ended = [&](const SearchResult& each) {
    Trial trial{each.model, held_out(each.model, signals, blocks)};
    trial.rmse =
        trial.held_out.finite ? trial.held_out.rmse() : std::numeric_limits<double>::infinity();
    return trial;
  };
  // Which kind comes last says nothing of two searches: the error decides.
  const auto by_error = [](const Trial&) { return false; };
  const std::vector<Trial> both{ended(one), ended(other)};
  return chosen_of(both, without_any, options, by_error) == 0 ? one : other;
}

const Addition* bursts_of(const SearchResult& result) {
  const auto bursts = std::ranges::find_if(result.additions, [](const Addition& addition) {
    return passes_over_samples(addition.tried[addition.chosen]);
  });
  return bursts == result.additions.end() ? nullptr : &*bursts;
}

// From the baseline, and once more without the bursts from the start, Eq. DG-53.
SearchResult searched(const Forward& forward, const Signals& signals, const Blocks& blocks,
                      const SearchOptions& options) {
  SearchResult result = forward.from_baseline();
  const Addition* const bursts = bursts_of(result);
  if (bursts == nullptr || bursts == &result.additions.front()) return result;
  const SearchResult other =
      forward.without_bursts(bursts->tried[bursts->chosen].model.effects.back());
  if (other.additions.empty() || same_effects(other.model, result.model)) return result;
  return better_of(result, other, other.additions.front().after.rmse(), signals, blocks, options);
}

}  // namespace

SearchResult search(const Baseline& baseline, const Signals& signals, const Blocks& blocks,
                    const SearchOptions& options, const ForEach& for_each,
                    const std::function<bool(const std::string&)>& progress) {
  const Forward any(baseline, signals, blocks, options, for_each, progress, false);
  SearchResult result = searched(any, signals, blocks, options);
  if (!turns_round(result.model, signals)) return result;
  const Forward rising(baseline, signals, blocks, options, for_each, progress, true);
  const SearchResult other = searched(rising, signals, blocks, options);
  // Errors of other samples are not compared.
  const bool comparable = (bursts_of(result) == nullptr) == (bursts_of(other) == nullptr);
  if (!comparable || other.additions.empty() || turns_round(other.model, signals)) return result;
  return better_of(result, other, held_out(baseline.model, signals, blocks).rmse(), signals, blocks,
                   options);
}

}  // namespace stillhand::diagnosis
