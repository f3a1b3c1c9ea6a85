// SPDX-License-Identifier: Apache-2.0
#include "apps/study/report/output.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/plot/figure_table.hpp"
#include "apps/study/report/figures.hpp"
#include "apps/study/report/participants.hpp"
#include "apps/study/report/report_cells.hpp"
#include "apps/study/report/report_sections.hpp"
#include "apps/study/report/study_report.hpp"
#include "services/files/rig/sealed_file.hpp"

namespace stillhand::study {
namespace {

// Names of all files that a study can write.
std::vector<std::string> every_name(const report::StagedFolder& folder) {
  std::vector<std::string> names{"report.html",        "summary.json",  "metrics.csv",
                                 "subjects.csv",       "models.csv",    "moving_averages.csv",
                                 "open_loop.csv",      "trials.csv",    rig::kSealedFile,
                                 rig::kCommitmentFile, "diagnoses.csv", "findings.csv",
                                 "simulated.csv"};
  for (const char* figure : kFigureNames) {
    for (std::string& name : report::figure_files(figure)) names.push_back(std::move(name));
  }
  for (const std::string& page : folder.in_place(kParticipantPage, kPageEnding, kPageLead)) {
    names.push_back(page);
  }
  return names;
}

// The figures of the pages are in the pages alone.
void write_participants(const StudyRecord& record, const report::StagedFolder& folder) {
  for (const auto& [code, file] : participant_files(*record.recorded)) {
    const std::string name = file.substr(0, file.size() - std::string(kPageEnding).size());
    const auto drawings = report::draw(participant_figures(record, code, name));
    participant_page(record, code, drawings).write(folder.path() / file);
  }
}

void print_manova(const MultivariateResult& result, const std::string& of) {
  if (!result.manova) return;
  const auto& manova = *result.manova;
  fmt::print("MANOVA, {}: condition Wilks {:.3g} (p {:.3g}), subject Wilks {:.3g} (p {:.3g})\n", of,
             manova.condition.wilks_lambda, manova.condition.wilks.p, manova.subject.wilks_lambda,
             manova.subject.wilks.p);
}

void print_comparison(const Comparison& comparison) {
  if (!has_test(comparison)) return;
  fmt::print("paired t-test {}, p:", pair_word(comparison.from, comparison.to));
  for (const auto& test : comparison.tests) {
    if (!test) {
      fmt::print(" -");
    } else if (test->p > 0.0) {
      fmt::print(" {:.3g}", test->p);
    } else {
      fmt::print(" <1e-300");
    }
  }
  fmt::print("\n");
}

// Exclusions, planned comparisons with and without the rules, and the plan.
void print_registered(const StudyRecord& record) {
  if (record.recorded->registered) {
    const Registered& registered = *record.recorded->registered;
    for (const std::string& line : registered.excluded)
      fmt::print("excluded by a rule: {}\n", line);
    const auto show = [](const std::vector<PlannedComparison>& all, const char* which) {
      for (const PlannedComparison& planned : all) {
        if (!has_test(planned.comparison)) continue;
        fmt::print("planned {}, {}, p of Holm:",
                   pair_word(planned.comparison.from, planned.comparison.to), which);
        for (const auto& p : planned.p_holm) {
          fmt::print(" {}", p ? fmt::format("{:.3g}", *p) : std::string("-"));
        }
        fmt::print("\n");
      }
    };
    show(registered.planned, "with the rules");
    show(registered.planned_without, "without them");
  }
  for (const Needed& needed : record.needed) {
    fmt::print("{} {}, d_z {:.3g} ({}):", needed.comparison, session::kMetrics[needed.metric].title,
               needed.effect_dz, needed.effect);
    for (const Needed::At& at : needed.at) {
      fmt::print("{} {} participants for power {:.1f}", &at == &needed.at.front() ? "" : ",",
                 at.participants, at.wanted_power);
    }
    fmt::print("{}\n", needed.at.empty() ? " more participants than a study can have" : "");
  }
}

// Of --diagnose and --simulated.
void print_people(const StudyRecord& record) {
  if (record.diagnoses) {
    for (const RecurringEffect& effect : record.diagnoses->recurring) {
      fmt::print("lacking: {}{}, {}: {} of {} people, {:.2f} N\n", effect.kind,
                 effect.channel.empty() ? "" : " (" + effect.channel + ")", effect.where,
                 effect.participants.size(), record.diagnoses->people.size(), effect.explained_n);
    }
    for (const auto& [code, why] : record.diagnoses->failed) {
      fmt::print("not diagnosed: {}: {}\n", code, why);
    }
  }
  if (!record.simulated) return;
  for (const auto& [code, why] : record.simulated->failed) {
    fmt::print("not simulated: {}: {}\n", code, why);
  }
  if (record.simulated->same_people) fmt::print("{}\n", chance_sentence(*record.simulated));
}

}  // namespace

void write_study(const StudyRecord& record, report::StagedFolder& folder) {
  for (const CsvFile& file : csv_files(record)) folder.write(file.name, file.text);
  const auto drawings = report::render(study_figures(record), folder.path());
  study_report(record, drawings).write(folder.path() / "report.html");
  if (record.recorded) write_participants(record, folder);
  folder.write("summary.json", summary_json(record));
  if (!record.sealed.empty()) {
    folder.write(rig::kCommitmentFile, digest::digest_line(record.sealed, rig::kSealedFile));
    folder.write(rig::kSealedFile, record.sealed);
  }
  folder.publish(every_name(folder));
}

void print_study(const StudyRecord& record) {
  const Analysis& analysis = record.analysis;
  if (const std::string state = state_of(record); !state.empty()) fmt::print("{}\n", state);
  if (record.recorded && subjects_of(record) == Subjects::kSimulated) {
    fmt::print("{}\n", report::kSimulatedBanner);
  }
  fmt::print("\n{}", report::in_plain_text(numbers_table(analysis)));
  if (analysis.restoration.size() > analysis.restoration.count(kC)) {
    fmt::print("{}", report::in_plain_text(restorations_table(analysis)));
  }
  fmt::print("The paper's RMS error has no unit; {:.1f} mm a unit is assumed.{}\n", kPaperUnit_mm,
             record.recorded                 ? ""
             : is_calibrated(record.options) ? " A and B are calibrated, C is a prediction."
                                             : " A and B were calibrated with another population "
                                               "or other lengths.");
  for (const Comparison& comparison : analysis.comparisons) print_comparison(comparison);
  if (record.recorded) {
    for (const std::string& line : record.recorded->left_out) fmt::print("left out: {}\n", line);
    for (const std::string& line : record.recorded->remarks) fmt::print("remark: {}\n", line);
    print_registered(record);
    print_people(record);
  }
  print_manova(analysis.main_effects, "main effects");
  if (analysis.all_main_effects) {
    print_manova(*analysis.all_main_effects, "main effects, " + words_of_conditions(analysis));
  }
}

}  // namespace stillhand::study
