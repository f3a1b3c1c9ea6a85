// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/report/diagnoses_output.hpp"
#include "apps/study/report/figures.hpp"
#include "apps/study/report/participants.hpp"
#include "apps/study/report/report_cells.hpp"
#include "version.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::Colour;
using report::Emphasis;
using report::Kind;
using report::number;
using session::kMetrics;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<const RecordedTrial*> trials_of(const RecordedSource& source, const std::string& code) {
  std::vector<const RecordedTrial*> out;
  for (const RecordedTrial& trial : source.trials) {
    if (trial.participant == code) out.push_back(&trial);
  }
  return out;
}

// Of each condition the last complete trial: a trace has no mean.
std::map<Condition, const TrackedTrial*> last_trials(const RecordedSource& source,
                                                     const std::string& code) {
  std::map<Condition, const TrackedTrial*> out;
  for (const RecordedTrial* trial : trials_of(source, code))
    out[trial->condition] = &trial->tracked;
  return out;
}

double own_value(const SubjectResult* own, Condition condition, std::size_t metric) {
  if (own == nullptr || !own->trials.contains(condition)) return kNan;
  return kMetrics[metric].of(own->trials.at(condition));
}

// The person among the others: every participant, the own value, the paper's mean.
report::Panel among_panel(const StudyRecord& record, const SubjectResult* own, std::size_t metric) {
  report::Panel panel;
  panel.title = kMetrics[metric].title;
  panel.y.low = 0.0;
  panel.legend = report::Legend::kNone;
  report::Series others{.kind = Kind::kPoints, .colour = Colour::kNeutral};
  report::Series one{.kind = Kind::kPoints, .colour = Colour::kWarning};
  report::Series paper{.kind = Kind::kPoints, .colour = Colour::kTarget};
  others.point_size = 0.6;
  one.point_size = 1.5;
  double place = 1.0;
  for (const auto& [condition, metrics] : record.analysis.conditions) {
    for (const double value : metrics[metric].per_subject) {
      others.x.push_back(place);
      others.y.push_back(value);
    }
    one.x.push_back(place - 0.18);
    one.y.push_back(own_value(own, condition, metric));
    if (condition <= kC) {
      paper.x.push_back(place + 0.18);
      paper.y.push_back(paper_value(metric, condition));
    }
    panel.x.ticks.push_back({place, name_of(condition)});
    place += 1.0;
  }
  panel.x.low = 0.4;
  panel.x.high = place - 0.4;
  panel.series = {others, one};
  if (!paper.x.empty()) panel.series.push_back(paper);
  return panel;
}

report::Table numbers_table(const StudyRecord& record, const SubjectResult* own) {
  report::Table table;
  table.caption =
      "The participant, the group of the report's tables, and the paper's means. The distance from "
      "the group's mean is in standard deviations of the group.";
  table.header = {"metric", "condition", "own", "group, mean ± SD", "distance", "paper"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    for (const auto& [condition, metrics] : record.analysis.conditions) {
      const double value = own_value(own, condition, k);
      const MetricSample& group = metrics[k];
      const double spread = group.standard_deviation.value_or(kNan);
      table.rows.push_back(
          {kMetrics[k].title, name_of(condition),
           Cell(number(value, decimals(k)), Emphasis::kStrong), mean_and_deviation(group, k),
           number((value - group.mean) / spread, 1),
           Cell(condition <= kC ? number(paper_value(k, condition), decimals(k)) : "–",
                Emphasis::kFaint)});
    }
  }
  return table;
}

report::Table restored_table(const StudyRecord& record, const SubjectResult* own) {
  report::Table table;
  table.caption =
      "Restoration (B − X)/(B − A): the participant's, the group's with its interval, the paper's.";
  table.header = {"metric", "canceller", "own", "group [95 %]", "paper"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    for (const auto& entry : record.analysis.restoration) {
      const double a = own_value(own, kA, k);
      const double b = own_value(own, kB, k);
      const double share = (b - own_value(own, entry.first, k)) / (b - a);
      table.rows.push_back(
          {kMetrics[k].title, name_of(entry.first),
           Cell(std::isfinite(share) ? report::restored(share) : "–", Emphasis::kStrong),
           restored_text(record.analysis, k, entry.first),
           Cell(entry.first == kC ? number(kMetrics[k].paper->restored_percent, 0) + " %" : "–",
                Emphasis::kFaint)});
    }
  }
  return table;
}

report::Table trials_table(const RecordedSource& source, const std::string& code) {
  report::Table table;
  table.caption =
      "Every complete tracking trial, in the order of the session. Block and place are those of "
      "the registered plan. Used: the trial is in the tables.";
  table.header = {"trial", "session", "block", "place", "condition"};
  for (const session::Number& each : session::samples()) table.header.emplace_back(each.title);
  table.header.insert(table.header.end(), {"lost [%]", "used"});
  const auto planned = [](std::int64_t n) { return n > 0 ? std::to_string(n) : std::string("–"); };
  for (const RecordedTrial* trial : trials_of(source, code)) {
    const bool used = source.used.contains(id_of(*trial));
    std::vector<Cell> row{std::to_string(trial->number), trial->session, planned(trial->block),
                          planned(trial->step), name_of(trial->condition)};
    for (const session::Number& each : session::samples()) {
      row.emplace_back(number(each.of(trial->tracked), each.decimals));
    }
    row.emplace_back(number(100.0 * trial->lost_share, 1));
    row.emplace_back(used ? "yes" : "no", used ? Emphasis::kNone : Emphasis::kFaint);
    table.rows.push_back(row);
  }
  table.align.assign(table.header.size(), report::Align::kRight);
  return table;
}

std::string order_of(const RecordedSource& source, const std::string& code) {
  std::string out;
  for (const RecordedTrial* trial : trials_of(source, code)) {
    out += (out.empty() ? "" : " ") + std::string(name_of(trial->condition));
  }
  return out;
}

}  // namespace

std::vector<report::Figure> participant_figures(const StudyRecord& record, const std::string& code,
                                                const std::string& name) {
  const SubjectResult* own = result_of(record, code);
  report::Figure among{
      .name = name + "_among",
      .caption = fmt::format("{} (red) among the participants of the tables (grey); black: the "
                             "paper's means, at {} mm a unit of RMS error.",
                             code, number(kPaperUnit_mm, 1)),
      .panels = {},
      .columns = 3,
      .width_px = 980,
      .height_px = 330};
  for (std::size_t k = 0; k < kMetricCount; ++k)
    among.panels.push_back(among_panel(record, own, k));
  std::vector<report::Figure> out{among};
  out.push_back(traces_figure(
      last_trials(*record.recorded, code), name + "_traces",
      "Up to twenty seconds from the middle of a trial of each condition; of several trials the "
      "last."));
  if (own != nullptr) {
    out.push_back(estimate_figure(
        own->identification, name + "_model",
        "Feedthrough of the pegged trial by cross-spectrum over spectrum, with its 95 % band and "
        "coherence, and the fitted models."));
  }
  return out;
}

report::Page participant_page(const StudyRecord& record, const std::string& code,
                              const std::vector<report::Drawing>& drawings) {
  const RecordedSource& source = *record.recorded;
  const SubjectResult* own = result_of(record, code);
  const bool in_tables = std::ranges::find(source.participants, code) != source.participants.end();
  report::Page page("Participant " + code, kPageLead);
  if (source.simulated.contains(code)) page.banner(report::kSimulatedBanner);
  page.facts({{"participant", code},
              {"order", order_of(source, code)},
              {"in the tables", in_tables ? "yes" : "no"},
              {"trial", report::short_number(record.options.protocol.trial_s) + " s"},
              {"version", kVersion}});
  page.link("Report of the study", "report.html");
  const std::vector<std::string> remarks = remarks_on(source, code);
  if (!remarks.empty()) page.list(remarks);
  if (!in_tables) page.warning("This participant is not in the tables and figures of the report.");
  const auto show = [&](std::string_view ending) {
    for (const report::Drawing& drawing : drawings) {
      if (drawing.name.ends_with(ending)) page.figure(drawing);
    }
  };
  page.section("Own numbers");
  show("_among");
  page.table(numbers_table(record, own));
  if (!record.analysis.restoration.empty()) page.table(restored_table(record, own));
  page.section("Trials");
  page.table(trials_table(source, code));
  show("_traces");
  page.section("Identification");
  if (own == nullptr) {
    page.paragraph("No complete pegged trial, or not every condition: see above.");
  } else {
    const auto& found = own->identification;
    page.paragraph(
        fmt::format("The model explains {} % of the force on samples that the fit did not see. {}",
                    number(found.paper.heldout.free_run_vaf_percent, 1),
                    found.paper_unusable.empty()
                        ? "It is the paper's fit."
                        : "The paper's fit could not be used; the free-run fit was used instead."));
    show("_model");
  }
  add_diagnosis(page, record, code);
  return page;
}

void add_participants(report::Page& page, const StudyRecord& record) {
  if (!record.recorded) return;
  const RecordedSource& source = *record.recorded;
  const auto files = participant_files(source);
  page.section("Participants");
  report::Table table;
  table.caption =
      "Each participant has a page, including those who are not in the tables. RMS errors [mm] are "
      "means over the participant's trials.";
  table.header = {"participant", "trials"};
  for (const auto& entry : record.analysis.conditions) {
    table.header.push_back(std::string("RMS ") + name_of(entry.first));
  }
  table.header.push_back("in the tables");
  for (const auto& [code, file] : files) {
    const SubjectResult* own = result_of(record, code);
    const bool in_tables =
        std::ranges::find(source.participants, code) != source.participants.end();
    std::vector<Cell> row{report::linked(code, file),
                          std::to_string(trials_of(source, code).size())};
    for (const auto& entry : record.analysis.conditions) {
      row.emplace_back(number(own_value(own, entry.first, 0), 1));
    }
    row.emplace_back(in_tables ? "yes" : "no", in_tables ? Emphasis::kNone : Emphasis::kFaint);
    table.rows.push_back(row);
  }
  page.table(table);
}

}  // namespace stillhand::study
