// SPDX-License-Identifier: Apache-2.0
#include "apps/study/report/diagnoses_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/or_null.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/study/recorded/whose.hpp"
#include "apps/study/report/csv_cells.hpp"
#include "apps/study/report/figures.hpp"
#include "apps/study/report/participants.hpp"
#include "apps/study/report/report_cells.hpp"

namespace stillhand::study {
namespace {

using close_the_loop::Finding;
using close_the_loop::Level;
using close_the_loop::Remaining;
using nlohmann::ordered_json;
using report::Colour;
using report::Kind;
using report::number;
using report::or_null;

ordered_json level_json(const Level& level) {
  ordered_json out{{"rms_n", level.rms}, {"interval95", nullptr}};
  if (level.interval95) out["interval95"] = {level.interval95->first, level.interval95->second};
  return out;
}

ordered_json left_json(const std::optional<Remaining>& remaining) {
  return remaining ? level_json(remaining->left) : ordered_json(nullptr);
}

ordered_json person_json(const PersonDiagnosis& person) {
  ordered_json findings = ordered_json::array();
  for (const Finding& finding : person.findings) {
    findings.push_back({{"kind", finding.kind},
                        {"channel", or_null(finding.channel)},
                        {"where", finding.where},
                        {"explained_n", finding.explained_n},
                        {"heldout_before_n", finding.before_n},
                        {"heldout_after_n", finding.after_n},
                        {"evidence", finding.evidence}});
  }
  ordered_json out{
      {"verdict", person.verdict}, {"findings", findings}, {"unseen_s", person.unseen_s}};
  out["without"] = person.by_linear ? level_json(person.by_linear->without) : ordered_json(nullptr);
  out["left_by_c"] = left_json(person.by_linear);
  out["left_by_c_plus"] = left_json(person.by_augmented);
  out["gain_n"] = or_null(person.gain_n());
  out["not_replayed"] = or_null(person.not_replayed);
  return out;
}

std::string effect_words(const std::string& kind, const std::string& channel,
                         const std::string& where) {
  return diagnose::spaced(kind) + (channel.empty() ? "" : " (" + channel + ")") + ", " + where;
}

std::string level_text(const Level& level) {
  std::string text = number(level.rms, 2);
  if (!level.interval95) return text;
  return fmt::format("{} [{}, {}]", text, number(level.interval95->first, 2),
                     number(level.interval95->second, 2));
}

std::string left_text(const std::optional<Remaining>& remaining) {
  return remaining ? level_text(remaining->left) : "–";
}

const char* owner(Whose whose) {
  constexpr std::array kOwners{"the rig's", "a person's", "not decided"};
  return kOwners.at(static_cast<std::size_t>(whose));
}

// Whether to mend the rig before modelling each person.
std::string mend_first(const Diagnoses& diagnoses) {
  const double of_rig = share_of(diagnoses, Whose::kRig);
  if (of_rig == 0.0) return "No effect is the rig's as far as these people show.";
  const bool pays = of_rig > 1.0 - of_rig;
  return fmt::format(
      "{}: the rig's effects are {} % of the mean square force that the models of these people "
      "lack.",
      pays ? "Mend the rig first" : "Mending the rig is not the larger part",
      number(100.0 * of_rig, 0));
}

std::string left_out_sentence(const Diagnoses& diagnoses) {
  LeftOutPerson sum;
  for (const LeftOutPerson& each : leave_one_out(diagnoses.people)) {
    sum.found += each.found;
    sum.forecast += each.forecast;
    sum.false_ones += each.false_ones;
  }
  return fmt::format(
      "Each person left out in turn, the others forecast {} of the {} effects that were found, and "
      "{} that the person does not have.",
      sum.forecast, sum.found, sum.false_ones);
}

report::Table recurring_table(const Diagnoses& diagnoses) {
  report::Table table;
  table.caption = fmt::format(
      "Effects that the paper's model lacks, over the {} people with a diagnosis: in how many it "
      "was found, of those in whom it could have been; median RMS force over the people who have "
      "it; and the chance that the model of a newcomer lacks it.",
      diagnoses.people.size());
  table.header = {"effect", "whose", "people", "force [N]", "newcomer", "who"};
  for (const RecurringEffect& effect : diagnoses.recurring) {
    table.rows.push_back(
        {effect_words(effect.kind, effect.channel, effect.where), owner(effect.whose),
         fmt::format("{} of {}", effect.participants.size(), effect.able),
         number(effect.explained_n, 2), number(100.0 * newcomers_chance(effect), 0) + " %",
         fmt::format("{}", fmt::join(effect.participants, ", "))});
  }
  using enum report::Align;
  table.align = {kLeft, kLeft, kRight, kRight, kRight, kLeft};
  return table;
}

report::Table people_table(const StudyRecord& record) {
  report::Table table;
  table.caption =
      "RMS force on pegged samples that no fit saw [N], with its 95 % interval if they last 30 s "
      "or more: without a motor, with the linear model of C, and with the augmented model of C+. "
      "Canceller and motor run on the recorded motion.";
  table.header = {"participant", "verdict", "without", "left by C", "left by C+", "C+ gains"};
  const auto files = participant_files(*record.recorded);
  for (const auto& [code, person] : record.diagnoses->people) {
    const auto gain = person.gain_n();
    table.rows.push_back({report::linked(code, files.at(code)), person.verdict,
                          person.by_linear ? level_text(person.by_linear->without) : "–",
                          left_text(person.by_linear), left_text(person.by_augmented),
                          gain ? number(*gain, 2) : "–"});
  }
  table.align = {report::Align::kLeft, report::Align::kLeft};
  table.align.resize(table.header.size(), report::Align::kRight);
  return table;
}

// Who has no diagnosis, or nothing to compare, and why.
std::vector<std::string> missing_lines(const Diagnoses& diagnoses) {
  std::vector<std::string> out;
  for (const auto& [code, why] : diagnoses.failed) {
    out.push_back(fmt::format("{} is not diagnosed: {}", code, why));
  }
  for (const auto& [code, person] : diagnoses.people) {
    if (!person.not_replayed.empty()) {
      out.push_back(fmt::format("{} has no C+ to compare: {}", code, person.not_replayed));
    }
  }
  return out;
}

}  // namespace

std::string gain_sentence(const Diagnoses& diagnoses) {
  if (!diagnoses.gain) {
    return "There is no test of the gain of C+: fewer than two people have both C and C+, or the "
           "augmented model changes nobody's force.";
  }
  const auto& test = *diagnoses.gain;
  const bool less = test.mean_difference <= 0.0;
  return fmt::format(
      "Over {} people, C+ would have left {} N [{}, {}] {} than C (paired t-test, p = {}).", test.n,
      number(std::abs(test.mean_difference), 3), number(less ? -test.ci_high : test.ci_low, 3),
      number(less ? -test.ci_low : test.ci_high, 3), less ? "less" : "more", p_value(test.p));
}

ordered_json diagnoses_json(const Diagnoses& diagnoses) {
  ordered_json out{
      {"participants", ordered_json::object()}, {"failed", ordered_json::object()},
      {"recurring", ordered_json::array()},     {"rigs_share", share_of(diagnoses, Whose::kRig)},
      {"left_out", ordered_json::object()},     {"gain", nullptr}};
  for (const auto& [code, person] : diagnoses.people) {
    out["participants"][code] = person_json(person);
  }
  for (const auto& [code, why] : diagnoses.failed) out["failed"][code] = why;
  for (const RecurringEffect& effect : diagnoses.recurring) {
    out["recurring"].push_back({{"kind", effect.kind},
                                {"channel", or_null(effect.channel)},
                                {"where", effect.where},
                                {"people", effect.participants.size()},
                                {"participants", effect.participants},
                                {"explained_n", effect.explained_n},
                                {"able", effect.able},
                                {"whose", owner(effect.whose)},
                                {"newcomers_chance", newcomers_chance(effect)}});
  }
  for (const LeftOutPerson& each : leave_one_out(diagnoses.people)) {
    out["left_out"][each.participant] = {
        {"found", each.found}, {"forecast", each.forecast}, {"false", each.false_ones}};
  }
  if (diagnoses.gain) {
    const auto& test = *diagnoses.gain;
    out["gain"] = {{"people", test.n},
                   {"mean_n", -test.mean_difference},
                   {"ci95", {-test.ci_high, -test.ci_low}},
                   {"t", -test.t},
                   {"p", test.p}};
  }
  return out;
}

std::vector<CsvFile> diagnoses_csv(const Diagnoses& diagnoses) {
  std::string people =
      "participant,verdict,unseen [s],without [N],left by C [N],left by C+ [N],why not\n";
  std::string findings =
      "participant,kind,channel,where,explained [N],held-out error before [N],"
      "held-out error after [N]\n";
  const auto cell = [](const std::optional<Remaining>& remaining) {
    return remaining ? csv::text(remaining->left.rms) : std::string();
  };
  for (const auto& [code, person] : diagnoses.people) {
    people += csv::row({report::csv_quoted(code), person.verdict, csv::text(person.unseen_s),
                        person.by_linear ? csv::text(person.by_linear->without.rms) : "",
                        cell(person.by_linear), cell(person.by_augmented),
                        report::csv_quoted(person.not_replayed)});
    for (const Finding& finding : person.findings) {
      findings += csv::row({report::csv_quoted(code), finding.kind, finding.channel, finding.where,
                            csv::text(finding.explained_n), csv::text(finding.before_n),
                            csv::text(finding.after_n)});
    }
  }
  for (const auto& [code, why] : diagnoses.failed) {
    people += csv::row(
        {report::csv_quoted(code), "not diagnosed", "", "", "", "", report::csv_quoted(why)});
  }
  return {{"diagnoses.csv", people}, {"findings.csv", findings}};
}

report::Figure figure_gain(const Diagnoses& diagnoses) {
  report::Panel panel;
  panel.y = {.label = "RMS force [N]", .low = 0.0};
  report::Series without{
      .label = "without a motor", .kind = Kind::kPoints, .colour = Colour::kConditionB};
  report::Series linear{.label = "left by C", .kind = Kind::kPoints, .colour = Colour::kConditionC};
  report::Series augmented{
      .label = "left by C+", .kind = Kind::kPoints, .colour = Colour::kConditionCPlus};
  double place = 1.0;
  for (const auto& [code, person] : diagnoses.people) {
    panel.x.ticks.push_back({place, code});
    const auto add = [&](report::Series& series, double value, double shift) {
      series.x.push_back(place + shift);
      series.y.push_back(value);
    };
    if (person.by_linear) {
      add(without, person.by_linear->without.rms, 0.0);
      add(linear, person.by_linear->left.rms, -0.12);
    }
    if (person.by_augmented) add(augmented, person.by_augmented->left.rms, 0.12);
    place += 1.0;
  }
  panel.x.low = 0.4;
  panel.x.high = place - 0.4;
  panel.series = {without, linear, augmented};
  return {.name = kGainFigure,
          .caption =
              "Feedthrough force on pegged samples that no fit saw, for each participant: without "
              "a motor, and what C and C+ would have left.",
          .panels = {panel},
          .columns = 1,
          .width_px = 860,
          .height_px = 360};
}

void add_diagnoses(report::Page& page, const StudyRecord& record, const report::Drawing* drawing) {
  if (!record.diagnoses) return;
  const Diagnoses& diagnoses = *record.diagnoses;
  page.section("What the model lacks");
  page.paragraph(
      "The diagnosis of each participant is that of `stillhand close-the-loop`: the pegged trial "
      "shows the body, the last trial of B the stick, and the last trial of C the latency of the "
      "motor. It uses the recorded channels alone.");
  if (diagnoses.recurring.empty()) {
    page.paragraph("No effect was found in any participant.");
  } else {
    page.table(recurring_table(diagnoses));
    page.paragraph(mend_first(diagnoses) + " " + left_out_sentence(diagnoses));
  }
  if (!diagnoses.people.empty()) page.table(people_table(record));
  if (drawing != nullptr) page.figure(*drawing);
  page.paragraph(gain_sentence(diagnoses));
  const auto missing = missing_lines(diagnoses);
  if (!missing.empty()) page.list(missing);
}

void add_diagnosis(report::Page& page, const StudyRecord& record, const std::string& code) {
  if (!record.diagnoses) return;
  page.section("What the model lacks");
  const Diagnoses& diagnoses = *record.diagnoses;
  const auto found = diagnoses.people.find(code);
  if (found == diagnoses.people.end()) {
    const auto why = diagnoses.failed.find(code);
    page.paragraph("Not diagnosed: " +
                   (why == diagnoses.failed.end() ? "not in the tables" : why->second) + ".");
    return;
  }
  const PersonDiagnosis& person = found->second;
  page.paragraph("Verdict: " + person.verdict + ".");
  std::vector<std::string> lines;
  for (const Finding& finding : person.findings) {
    lines.push_back(fmt::format("{}, {} N RMS: {}",
                                effect_words(finding.kind, finding.channel, finding.where),
                                number(finding.explained_n, 2), finding.evidence));
  }
  if (!lines.empty()) page.list(lines);
  report::Table table;
  table.caption = fmt::format(
      "RMS force over {} s of pegged samples that no fit saw: without a motor, and what C and C+ "
      "would have left.",
      number(person.unseen_s, 0));
  table.header = {"", "force [N]"};
  if (person.by_linear) {
    table.rows.push_back({"without a motor", level_text(person.by_linear->without)});
  }
  table.rows.push_back({"C: linear model", left_text(person.by_linear)});
  table.rows.push_back({"C+: augmented model", left_text(person.by_augmented)});
  page.table(table);
  if (!person.not_replayed.empty()) {
    page.paragraph("No C+ to compare: " + person.not_replayed + ".");
  }
}

}  // namespace stillhand::study
