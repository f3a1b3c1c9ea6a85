// SPDX-License-Identifier: Apache-2.0
#include "services/core/next_run/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/fitting/fit.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/model_run.hpp"
#include "services/core/diagnosis/trials.hpp"

namespace stillhand::next_run {
namespace {

using diagnosis::Addition;
using diagnosis::Effect;
using diagnosis::Model;
using diagnosis::Trial;

constexpr double kNearlyTied = 2.0;  // [standard errors], as in the choice of a name, Eq. DG-17

// The same cause in another form is no rival.
bool same_cause(const Effect& one, const Effect& other) {
  return one.kind == other.kind && one.channels == other.channels;
}

bool is_rival(const Trial& trial, const Trial& chosen, const std::vector<std::string>& ties) {
  const Effect& effect = trial.model.effects.back();
  if (!std::isfinite(trial.rmse) || diagnosis::passes_over_samples(trial)) return false;
  return std::ranges::find(ties, effect.kind) != ties.end() ||
         diagnosis::compared(trial.held_out, chosen.held_out).t < kNearlyTied;
}

// The trial's model with those effects of the verdict that came after it; as in the search, one
// inside of the body at a time.
Candidate completed(const Trial& trial, const Model& found, std::size_t replaced,
                    const diagnosis::Signals& signals) {
  Candidate candidate{trial.model, trial.model.effects.size() - 1, trial.rmse};
  std::vector<Effect>& effects = candidate.model.effects;
  for (std::size_t e = 0; e < found.effects.size(); ++e) {
    const auto is_this = [&](const Effect& each) { return is_same(each, found.effects[e]); };
    const bool second_loop = acts_at(found.effects[e], diagnosis::Stage::kFeedback) &&
                             diagnosis::feedback_of(candidate.model) != nullptr;
    if (e != replaced && !second_loop && std::ranges::none_of(effects, is_this)) {
      effects.push_back(at_order(found.effects[e], found.body.order(), trial.model.body.order()));
    }
  }
  diagnosis::fit(candidate.model, signals, diagnosis::make_blocks(signals));
  return candidate;
}

// What a person or a laboratory can do to a channel, by its unit.
std::string instruction(const diagnosis::Signal& signal) {
  if (signal.unit == "degC" || signal.unit == "K") {
    return fmt::format("let {} change on its own: the same motion cold and warm", signal.source);
  }
  if (signal.unit == "N") {
    return fmt::format("change {} in the run: a firm hold in one half, a loose one in the other",
                       signal.source);
  }
  if (signal.quantity == diagnosis::Quantity::kAcceleration) {
    return fmt::format("move {} too, unlike the platform's motion: a second axis", signal.source);
  }
  if (signal.source == "roll") return "tilt the platform (roll) in the run, unlike its motion";
  if (signal.source == "theta" || signal.source == "omega") {
    return fmt::format(
        "move {} on its own: with the stick free, once with the motor and once without it",
        signal.source);
  }
  return fmt::format("move {} on its own", signal.source);
}

// Before the body or after it: there without a person, too.
bool of_the_chain(const Effect& effect) {
  const diagnosis::Stage stage = diagnosis::effect_kind(effect.kind).stage(effect);
  return stage == diagnosis::Stage::kInputTime || stage == diagnosis::Stage::kInputValue ||
         stage == diagnosis::Stage::kOutputValue;
}

void add_way(const Candidate& one, const Candidate& other, const diagnosis::Signals& signals,
             std::vector<std::string>& ways) {
  const Effect& effect = one.cause();
  for (const std::string& channel : effect.channels) {
    const diagnosis::Signal& signal = signals.at(channel);
    const auto& others = other.cause().channels;
    if (signals.is_input(signal.source) || std::ranges::any_of(others, [&](const auto& o) {
          return signals.at(o).source == signal.source;
        })) {
      continue;
    }
    ways.push_back(instruction(signal));
  }
  if (of_the_chain(effect) && !of_the_chain(other.cause())) {
    ways.push_back(fmt::format(
        "fasten a mass to the stick in place of the hand, and repeat the run: {} of the measuring "
        "chain stays, {} of the body goes",
        effect.kind, other.cause().kind));
  }
  if (diagnosis::effect_kind(effect.kind).time_only(effect)) {
    ways.push_back(fmt::format(
        "repeat the run after a pause: {} goes with time, and need not come again", effect.kind));
  }
}

}  // namespace

std::vector<Candidate> candidates_of(const diagnosis::Diagnosis& diagnosis, std::size_t effect,
                                     const diagnosis::Signals& signals) {
  const Addition& addition = diagnosis.search.additions[effect];
  const Trial& chosen = addition.tried[addition.chosen];
  std::vector<const Trial*> taken{&chosen};
  for (const Trial& trial : addition.tried) {  // best first
    const auto is_taken = [&](const Trial* each) {
      return same_cause(each->model.effects.back(), trial.model.effects.back());
    };
    if (taken.size() < kMostCandidates && is_rival(trial, chosen, diagnosis.effects[effect].ties) &&
        std::ranges::none_of(taken, is_taken)) {
      taken.push_back(&trial);
    }
  }
  if (taken.size() < 2) return {};
  std::vector<Candidate> candidates;
  for (const Trial* trial : taken) {
    candidates.push_back(completed(*trial, diagnosis.model, effect, signals));
  }
  return candidates;
}

std::vector<std::string> other_ways(const Candidate& one, const Candidate& other,
                                    const diagnosis::Signals& signals) {
  std::vector<std::string> ways;
  add_way(one, other, signals, ways);
  add_way(other, one, signals, ways);
  return ways;
}

std::string name_of(const Candidate& candidate) {
  const Effect& cause = candidate.cause();
  return fmt::format("{} ({}{}{})", cause.kind, cause.channels.empty() ? "" : "of ",
                     cause.channels.empty() ? "" : cause.channels.front() + ", ", cause.form);
}

}  // namespace stillhand::next_run
