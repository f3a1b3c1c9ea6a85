// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/diagnosis_report.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/diagnose/page/evidence.hpp"
#include "apps/diagnose/page/figures.hpp"
#include "apps/diagnose/page/report_tables.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/plot/figure_table.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Diagnosis;
using report::Page;
using report::short_number;

using Pairs = std::vector<std::pair<std::string, std::string>>;

std::string comma_separated(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

Pairs facts_of(const Evidence& evidence, const std::vector<std::string>& recordings) {
  const Diagnosis& found = evidence.found;
  const diagnosis::Signals& signals = evidence.signals;
  std::vector<std::string> inputs;
  for (const diagnosis::Signal& input : signals.inputs()) {
    inputs.push_back(axis_label(input.name, input.unit));
  }
  const std::size_t order = found.baseline.model.body.order();
  Pairs facts{
      {"made by", report::made_by()},
      {"command line", report::command_line()},
      {"verdict", found.verdict()},
      {recordings.size() == 1 ? "recording" : "recordings, diagnosed together",
       comma_separated(recordings)},
      {"input", comma_separated(inputs)},
      {"output", axis_label(signals.output().name, signals.output().unit)},
      {"sample rate", short_number(found.sample_rate_hz) + " Hz"},
      {"samples", std::to_string(signals.size())},
      {"length", report::number(signals.duration_s(), 1) + " s"},
      {"pieces without a gap", std::to_string(signals.stretches().size())},
      {"inputs excite", short_number(signals.lowest_excited_hz()) + " to " +
                            short_number(signals.highest_excited_hz()) + " Hz"},
      {"baseline", order == 0 ? found.model_class + ", static"
                              : found.model_class + ", order " + std::to_string(order)},
      {"output, standard deviation", shown(signals.output().deviation, signals.output().unit)}};
  if (const auto& lines = found.before.lines) {
    const double period_s = static_cast<double>(lines->periodicity.period) / found.sample_rate_hz;
    facts.emplace_back("excitation repeats", std::to_string(lines->repeats.periods) +
                                                 " periods of " + short_number(period_s) + " s");
  }
  return facts;
}

void add_figure(Page& page, const std::vector<report::Drawing>& drawings, const std::string& name) {
  const auto at = std::ranges::find(drawings, name, &report::Drawing::name);
  if (at != drawings.end()) page.figure(*at);
}

void add_errors(Page& page, const Evidence& evidence,
                const std::vector<report::Drawing>& drawings) {
  const Diagnosis& found = evidence.found;
  page.section("Error before and after");
  page.table(error_table(found));
  page.paragraph("The noise floor is the estimated error of a perfect model. Its source: " +
                 shown_sentence(found.noise_floor.method, found.output_unit) + ".");
  add_figure(page, drawings, "prediction");
  add_figure(page, drawings, "residual_spectra");
}

void add_effects(Page& page, const Evidence& evidence,
                 const std::vector<report::Drawing>& drawings) {
  const Diagnosis& found = evidence.found;
  page.section("What the baseline lacks");
  if (found.effects.empty()) {
    page.paragraph("No effect was found.");
  } else {
    page.table(effect_table(found));
    for (std::size_t e = 0; e < std::min(found.effects.size(), kMostEffectFigures); ++e) {
      add_figure(page, drawings, "effect_" + std::to_string(e + 1));
    }
  }
  if (found.search.removed > 0) {
    page.paragraph(std::to_string(found.search.removed) +
                   " effect(s) were removed again: later ones explain the same.");
  }
  page.table(parameter_table(evidence));
}

void add_remainder(Page& page, const Diagnosis& found,
                   const std::vector<report::Drawing>& drawings) {
  page.section("What is left");
  if (found.unexplained) {
    const diagnosis::Unexplained& left = *found.unexplained;
    page.warning("Not explained: " + shown_sentence(left.what, found.output_unit) + ".");
    std::vector<std::string> items{"band: " + short_number(left.band_hz[0]) + " to " +
                                   short_number(left.band_hz[1]) +
                                   " Hz hold the middle 80 % of its power"};
    std::vector<std::string> times;
    for (const double time_s : left.times_s) times.push_back(short_number(time_s) + " s");
    if (!times.empty()) items.push_back("strongest around " + comma_separated(times));
    if (!left.channels.empty()) items.push_back("depends on " + comma_separated(left.channels));
    page.list(items);
  } else {
    page.paragraph(
        "The residual depends on none of the quantities that were tested. The engine takes it for "
        "noise.");
  }
  for (const char* name :
       {"residual_over_time", "autocorrelation", "partial_coherence", "detection_lines"}) {
    add_figure(page, drawings, name);
  }
  page.table(detection_table(found));
  page.table(limit_table(found));
}

void add_search(Page& page, const Evidence& evidence) {
  page.section("What was tried");
  page.paragraph(
      "Each kind of effect that the residual suggests was fitted together with the linear part and "
      "compared on held-out blocks. Of those that the data do not distinguish, the simplest was "
      "taken. Candidates far behind the best were fitted for a few steps only.");
  for (const report::Table& table : tried_tables(evidence)) page.table(table);
  const std::string silent = never_proposed(evidence.found);
  if (!silent.empty())
    page.paragraph("Nothing in the residual suggests these kinds: " + silent + ".");
}

}  // namespace

Page diagnosis_page(const Evidence& evidence, const std::vector<std::string>& recordings,
                    const std::vector<report::Drawing>& drawings,
                    const std::vector<RecordedSplit>& splits) {
  const Diagnosis& found = evidence.found;
  const std::string& first = recordings.front();
  Page page(
      "Diagnosis: " + found.options.output + " from " + first.substr(first.find_last_of('/') + 1) +
          (recordings.size() == 1 ? "" : " and " + std::to_string(recordings.size() - 1) + " more"),
      fmt::format(
          "{}{}{}", verdict_in_words(found),
          found.drawn_names ? fmt::format(" {}.", draws_in_words(*found.drawn_names)) : "",
          found.stability ? fmt::format(" {}.", stability_in_words(*found.stability)) : ""));
  std::vector<std::string> notes = found.notes;
  for (const diagnosis::SampleFault& fault : found.screening) {
    page.warning(fault.says);
    std::erase(notes, fault.says);
  }
  add_splits(splits, page);
  page.facts(facts_of(evidence, recordings));
  if (!notes.empty()) page.list(notes);
  add_errors(page, evidence, drawings);
  add_effects(page, evidence, drawings);
  add_remainder(page, found, drawings);
  add_search(page, evidence);
  return page;
}

void write_report(const Diagnosis& found, const diagnosis::Measurement& measurement,
                  const std::vector<std::string>& recordings, report::StagedFolder& folder,
                  const std::vector<RecordedSplit>& splits) {
  const Evidence evidence(found, measurement);
  const auto drawings = report::render(diagnosis_figures(evidence), folder.path());
  diagnosis_page(evidence, recordings, drawings, splits).write(folder.path() / "report.html");
  std::vector<std::string> names{"report.html"};
  for (const std::string& name : figure_names()) {
    for (std::string& file : report::figure_files(name)) names.push_back(std::move(file));
  }
  folder.publish(names);
}

}  // namespace stillhand::diagnose
