// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/report_tables.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/diagnose/page/effect_numbers.hpp"
#include "apps/diagnose/page/questions.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Diagnosis;
using diagnosis::FoundEffect;
using diagnosis::HeldOutError;
using report::Align;
using report::Cell;
using report::Emphasis;
using report::short_number;
using report::Table;

constexpr std::size_t kMostTried = 10;
constexpr std::size_t kMostQuestions = 15;

std::vector<Cell> error_row(const std::string& name, const HeldOutError& error,
                            const HeldOutError& before, double floor) {
  const double change = error.rmse / before.rmse - 1.0;
  return {name,
          Cell(short_number(error.rmse), Emphasis::kStrong),
          interval(error.low, error.high),
          report::number(error.vaf_percent, 2),
          &error == &before ? Cell("–") : Cell(percent(change, 1)),
          report::number(error.rmse / floor, 2)};
}

std::string listed(const std::vector<std::string>& names) {
  return names.empty() ? "–" : fmt::format("{}", fmt::join(names, ", "));
}

std::string error_text(const ModelNumber& number) {
  if (std::isfinite(number.standard_error)) return short_number(number.standard_error);
  return number.origin == "given" || number.origin == "searched" ? "not fitted" : "not determined";
}

void add_numbers(Table& table, const std::string& of, const std::vector<ModelNumber>& numbers) {
  bool first = true;
  for (const ModelNumber& number : numbers) {
    table.rows.push_back({first ? of : "", number.name,
                          Cell(short_number(number.value), Emphasis::kStrong), error_text(number),
                          number.unit, number.origin});
    first = false;
  }
}

// One step of the search.
struct Step {
  const diagnosis::HeldOut& before;
  const std::vector<diagnosis::Trial>& tried;
  std::size_t chosen;  // beyond the end: none
  const diagnosis::SearchOptions& options;
};

Cell outcome_of(const Step& step, std::size_t i) {
  if (i == step.chosen) return {"added", Emphasis::kGood};
  const diagnosis::Trial& trial = step.tried[i];
  if (!trial.fitted) return {"not fitted: nothing to gain", Emphasis::kFaint};
  if (diagnosis::is_by_chance(trial)) return {"by chance", Emphasis::kFaint};
  const bool tied =
      std::isfinite(trial.rmse) && step.chosen < step.tried.size() &&
      diagnosis::ties_with(trial, step.tried[step.chosen], step.before.rmse(), step.options);
  return tied ? Cell("close", Emphasis::kStrong) : Cell("rejected", Emphasis::kFaint);
}

void add_trial(Table& table, const Step& step, std::size_t i) {
  const diagnosis::Trial& trial = step.tried[i];
  const diagnosis::Effect& effect = trial.model.effects.back();
  const bool finite = std::isfinite(trial.rmse) && trial.held_out.finite;
  table.rows.push_back({spaced(effect.kind), effect.form, listed(effect.channels),
                        std::to_string(diagnosis::complexity(trial.model)),
                        finite ? short_number(trial.rmse) : "–",
                        finite ? percent(trial.rmse / step.before.rmse() - 1.0, 1) : "–",
                        finite ? p_value(diagnosis::compared(step.before, trial.held_out).p) : "–",
                        outcome_of(step, i)});
}

// Another start of the same fit.
bool ends_as_chosen(const Step& step, std::size_t i) {
  if (i == step.chosen || step.chosen >= step.tried.size()) return false;
  const auto& own = step.tried[i].model.effects.back();
  const auto& chosen = step.tried[step.chosen].model.effects.back();
  return own.kind == chosen.kind && own.form == chosen.form && own.channels == chosen.channels &&
         short_number(step.tried[i].rmse) == short_number(step.tried[step.chosen].rmse);
}

Table tried_table(const Diagnosis& found, const Step& step, const std::string& caption) {
  Table table;
  table.caption = caption;
  table.header = {
      "kind",   "form", "signals", "numbers", "RMSE [" + shown_unit(found.output_unit) + "]",
      "change", "p",    "outcome"};
  table.align = {Align::kLeft,  Align::kLeft,  Align::kLeft,  Align::kRight,
                 Align::kRight, Align::kRight, Align::kRight, Align::kLeft};
  const std::size_t shown_rows = std::min(step.tried.size(), kMostTried);
  for (std::size_t i = 0; i < shown_rows; ++i) {
    if (!ends_as_chosen(step, i)) add_trial(table, step, i);
  }
  if (step.chosen >= shown_rows && step.chosen < step.tried.size()) {
    add_trial(table, step, step.chosen);
  }
  return table;
}

Cell own_size(const FoundEffect& effect) {
  const std::string text = short_number(effect.explained.rms) + " [" +
                           short_number(effect.explained.low) + ", " +
                           short_number(effect.explained.high) + "]";
  return effect.counts ? Cell(text) : Cell(text + ", does not count", Emphasis::kFaint);
}

std::string candidates_in_words(const std::vector<diagnosis::Trial>& tried) {
  const std::string count = std::to_string(tried.size());
  return tried.size() > kMostTried
             ? std::to_string(kMostTried) + " best of " + count + " candidates"
             : "all " + count + " candidates";
}

}  // namespace

Table error_table(const Diagnosis& found) {
  const std::string unit = shown_unit(found.output_unit);
  Table table;
  table.caption =
      "RMS error of the free run (from the inputs alone) on blocks of time that the fit has not "
      "seen (held out), and its 95 % interval over the blocks. VAF: variance accounted for, the "
      "share of the output's variance that is explained. All of this is within this recording; "
      "another one may leave more. The noise floor's range is that of its estimates, no interval "
      "of 95 %. Last column: the error over the noise floor.";
  table.header = {"model",  "RMSE [" + unit + "]", "95 % interval [" + unit + "]", "VAF [%]",
                  "change", "over the floor"};
  const double floor = found.noise_floor.rmse;
  table.rows.push_back(error_row("baseline", found.baseline_error, found.baseline_error, floor));
  const HeldOutError* before = &found.baseline_error;
  for (const FoundEffect& effect : found.effects) {
    table.rows.push_back(error_row("+ " + effect_title(effect), effect.after, *before, floor));
    before = &effect.after;
  }
  if (found.effects.size() > 1) {
    table.rows.push_back(
        error_row("final, against the baseline", found.final_error, found.baseline_error, floor));
  }
  if (!found.effects.empty()) {
    table.rows.push_back(error_row("saved model, against the baseline", found.carried_error,
                                   found.baseline_error, floor));
  }
  table.rows.push_back({"noise floor", Cell(short_number(floor), Emphasis::kStrong),
                        interval(found.noise_floor.low, found.noise_floor.high)});
  return table;
}

Table effect_table(const Diagnosis& found) {
  Table table;
  table.caption =
      "Effects in the order in which they were added. Form: through the body, the effect "
      "acts before the linear part; beside the body, it is added to the output. p: the probability "
      "of such an improvement by chance, from the signed ranks of the blocks, before the choice "
      "among candidates; N blocks give 2^-N at the least. Ties: other kinds that explain "
      "the record equally well; the simplest was taken. Saved: the part of the effect that holds "
      "in "
      "another recording, so that predict uses it. control-model prints what the motor does "
      "about it.";
  table.header = {
      "effect", "form", "evidence", "own size [" + shown_unit(found.output_unit) + "], 95 %",
      "p",      "ties", "saved"};
  table.align = {Align::kLeft,  Align::kLeft, Align::kLeft, Align::kRight,
                 Align::kRight, Align::kLeft, Align::kLeft};
  for (const FoundEffect& effect : found.effects) {
    table.rows.push_back({Cell(effect_title(effect), Emphasis::kStrong), effect.effect.form,
                          shown_sentence(effect.evidence, found.output_unit), own_size(effect),
                          p_value(effect.p), spaced(listed(effect.ties)),
                          carried_in_words(effect)});
  }
  return table;
}

Table parameter_table(const Evidence& evidence) {
  Table table;
  table.caption =
      "Numbers of the final model; baseline and effects are fitted together to the whole record. "
      "Standard errors are those of the linearised fit with noise of the residual's spectrum "
      "(DG-70, DG-71). A coefficient multiplies the effect's term. The model file holds the "
      "coefficients of a path through the body or of a loop.";
  table.header = {"part", "number", "value", "standard error", "unit", "origin"};
  table.align = {Align::kLeft,  Align::kLeft, Align::kRight,
                 Align::kRight, Align::kLeft, Align::kLeft};
  for (std::size_t e = 0; e < evidence.found.effects.size(); ++e) {
    add_numbers(table, effect_title(evidence.found.effects[e]), effect_numbers(evidence, e));
  }
  add_numbers(table, "linear part", body_numbers(evidence));
  return table;
}

std::vector<Table> tried_tables(const Evidence& evidence) {
  const Diagnosis& found = evidence.found;
  std::vector<Table> tables;
  for (std::size_t s = 0; s < found.search.additions.size(); ++s) {
    const diagnosis::Addition& addition = found.search.additions[s];
    std::string caption =
        "Step " + std::to_string(s + 1) + ": " + candidates_in_words(addition.tried) +
        ". RMSE: on held-out blocks" +
        (found.search.whitened ? ", behind the filter that makes the noise white" : "") +
        ". Numbers: the fitted ones of the whole model.";
    if (!addition.ties.empty()) {
      caption += " Close to the added one, for the search: " + spaced(listed(addition.ties)) + ".";
    }
    tables.push_back(tried_table(
        found, {addition.current, addition.tried, addition.chosen, found.options.search}, caption));
  }
  const auto& last = found.search.last_tried;
  if (!last.empty()) {
    const std::string caption =
        (tables.empty() ? std::string("No effect was worth adding: ")
                        : std::string("No further effect was worth adding: ")) +
        candidates_in_words(last) + ". An effect is added if the error falls by more than " +
        percent(found.options.search.least_fall, 0) + " and p is below " +
        short_number(found.options.search.significance) +
        " divided by the number of candidates (not divided if the error falls by more than " +
        percent(found.options.search.large_fall, 0) +
        "). By chance: copies of what the model leaves give as much. At most " +
        std::to_string(found.options.search.most_effects) + " effects are added.";
    tables.push_back(tried_table(
        found, {found.search.last_current, last, last.size(), found.options.search}, caption));
  }
  return tables;
}

Table limit_table(const Diagnosis& found) {
  Table table;
  table.caption =
      "What would not have been seen. Each kind was planted into what the model leaves, "
      "moved in time against the inputs, and the rule of the search was asked: the share of these "
      "residuals in which it was found, by the RMS that the effect adds to the output. Half: the "
      "size that is found in half of them; new to the model: the part of it that the model without "
      "the effect cannot imitate. Of several channels the one that is hardest to find.";
  table.header = {"kind"};
  table.align = {Align::kLeft};
  for (const double size : diagnosis::kPlantedSizes) {
    table.header.push_back("found at " + shown(size * found.final_error.rmse, found.output_unit));
    table.align.push_back(Align::kRight);
  }
  table.header.insert(table.header.end(), {"half", "new to the model"});
  table.align.insert(table.align.end(), {Align::kRight, Align::kRight});
  for (const diagnosis::PlantedLimit& limit : found.limits) {
    std::vector<Cell> row{spaced(limit.kind) +
                          (limit.channel.empty() ? "" : " (" + limit.channel + ")")};
    for (const double share : limit.found) {
      row.emplace_back(percent(share, 0), share < 0.5 ? Emphasis::kFaint : Emphasis::kStrong);
    }
    row.emplace_back(std::isfinite(limit.half) ? shown(limit.half, found.output_unit) : "never",
                     Emphasis::kStrong);
    row.emplace_back(percent(limit.beyond_linear, 0));
    table.rows.push_back(row);
  }
  return table;
}

Table detection_table(const Diagnosis& found) {
  Table table;
  table.caption =
      "Questions to the residual. Each adds columns to the model, and the model is fitted again. "
      "Share: the part of the residual's power that the columns explain on held-out blocks. p: "
      "(1 + n)/" +
      std::to_string(diagnosis::kSurrogates + 1) +
      ", where n surrogates answer any of the questions with as large a share. A surrogate is the "
      "residual moved in time, or with other phases. Lines have a test of their own.";
  const bool both = !found.effects.empty();
  table.header = {"question", "about", "share", "p", "found"};
  table.align = {Align::kLeft, Align::kLeft, Align::kRight, Align::kRight, Align::kLeft};
  if (both) {
    table.header = {"question",     "about",       "share before", "p before",
                    "found before", "share after", "p after",      "found after"};
    table.align.insert(table.align.end(), {Align::kRight, Align::kRight, Align::kLeft});
  }
  const auto add_answer = [](std::vector<Cell>& row, const diagnosis::Detection& answer) {
    row.emplace_back(percent(answer.share, 1));
    row.emplace_back(p_value(answer.p));
    row.push_back(answer.found ? Cell("yes", Emphasis::kBad) : Cell("no", Emphasis::kFaint));
  };
  for (const Answers& each : strongest_answers(found, kMostQuestions)) {
    const std::string& about = each.before.channel;
    std::vector<Cell> row{each.before.question, about.empty() ? "–" : about};
    add_answer(row, each.before);
    if (both) add_answer(row, each.after);
    table.rows.push_back(row);
  }
  return table;
}

std::string never_proposed(const Diagnosis& found) {
  std::set<std::string> proposed;
  const auto note = [&proposed](const std::vector<diagnosis::Trial>& tried) {
    for (const diagnosis::Trial& trial : tried) proposed.insert(trial.model.effects.back().kind);
  };
  for (const diagnosis::Addition& addition : found.search.additions) note(addition.tried);
  note(found.search.last_tried);
  std::vector<std::string> silent;
  for (const diagnosis::EffectKind* kind : diagnosis::effect_kinds()) {
    if (!proposed.contains(std::string(kind->name()))) silent.push_back(spaced(kind->name()));
  }
  return fmt::format("{}", fmt::join(silent, ", "));
}

}  // namespace stillhand::diagnose
