// SPDX-License-Identifier: Apache-2.0
#include "apps/study/report/study_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/study/report/diagnoses_output.hpp"
#include "apps/study/report/figures.hpp"
#include "apps/study/report/participants.hpp"
#include "apps/study/report/report_sections.hpp"

namespace stillhand::study {
namespace {

using report::number;
using report::short_number;

void add_identification(report::Page& page, const StudyRecord& record) {
  const std::int64_t unusable = record.analysis.refined_used;
  const std::string outcome =
      unusable == 0
          ? "All of the paper's fits were stable and were used to cancel."
          : fmt::format(
                "{} of {} of the paper's fits were unstable or could not be converted to "
                "1 kHz. For these subjects the free-run fit was used instead (models.csv).",
                unusable, record.options.subjects);
  page.paragraph(
      "Each subject's model is the paper's: the recording is low-passed at 10 Hz and reduced to "
      "50 Hz, and least squares fit four zeros and four poles. The figures also show the same "
      "model fitted on its free-run error, which output noise does not bias. " +
      outcome);
}

void add_open_questions(report::Page& page, const StudyRecord& record) {
  page.section("What the paper leaves open");
  const std::string frequencies =
      record.options.protocol.trial_s == 180.0
          ? "Trials last 180 s, as in the paper, so the fifteen frequencies are the printed ones."
          : fmt::format(
                "Trials of {} s cannot hold whole cycles of 1/180 Hz. The fifteen "
                "frequencies are harmonics of the trial's own length instead.",
                short_number(record.options.protocol.trial_s));
  // The strings of an item continue over several lines: no comma is missing.
  // NOLINTBEGIN(bugprone-suspicious-missing-comma)
  page.list(
      {"The RMS error has no unit. With a box of ±15 mm and a Gaussian error, the dwell ratios "
       "give "
       "23.3, 51.3 and 37.6 mm for A, B and C, which is 5.8, 5.3 and 5.4 mm a unit. This report "
       "uses 5.5 mm a unit. It also shows the ratio B/A, which needs no unit.",
       "Eq. 8 has no unit either. The target's scale is a setting of the display, chosen so that "
       "condition A has a dwell ratio near 0.48.",
       "The paper calls the multipliers relatively prime, but 87 = 3·29 and 310 = 2·5·31 share "
       "factors with others. They are used as printed; the display offers 89 and 311.",
       "The tracking motion is 0.7 to 2 Hz \"as mentioned above\", but 0.7 to 4 Hz is mentioned "
       "there. This study uses 0.7 to 4 Hz for identification and 0.7 to 2 Hz for tracking.",
       "An interaction of condition and subject cannot be tested with one value a cell. That test "
       "covers the main effects only. The interaction is tested with the thirds of a trial as "
       "replicates.",
       "The remnant biases X_p/X_e in a closed loop. The report gives this estimate and the one "
       "through the reference.",
       frequencies});
  // NOLINTEND(bugprone-suspicious-missing-comma)
}

void add_recorded_facts(report::Page& page, const StudyRecord& record) {
  const RecordedSource& source = *record.recorded;
  page.facts({{"participants", fmt::format("{}", fmt::join(source.participants, ", "))},
              {"complete tracking trials", std::to_string(source.trials.size())},
              {"trials in the tables", std::to_string(source.used.size())},
              {"trial", short_number(record.options.protocol.trial_s) + " s"},
              {"pegged trial", short_number(record.options.protocol.identify_s) + " s"},
              {"pre-registration", source.digest.empty() ? "none" : source.digest},
              {"made by", report::made_by()},
              {"command line", record.command_line}});
  if (source.used.size() > source.participants.size() * record.analysis.conditions.size()) {
    page.paragraph(
        "If a participant has several trials of a condition, each metric is their mean. Trials are "
        "excluded before the mean is taken; people are compared after.");
  }
  if (!source.left_out.empty()) {
    page.paragraph("Left out:");
    page.list(source.left_out);
  }
  if (!source.remarks.empty()) {
    page.paragraph("Remarks:");
    page.list(source.remarks);
  }
}

void add_lead_facts(report::Page& page, const StudyRecord& record) {
  const StudyOptions& options = record.options;
  if (record.recorded) {
    add_recorded_facts(page, record);
    return;
  }
  page.facts({{"subjects", std::to_string(options.subjects)},
              {"seed", std::to_string(options.seed)},
              {"trial", short_number(options.protocol.trial_s) + " s"},
              {"pegged trial", short_number(options.protocol.identify_s) + " s"},
              {"canceller", options.canceller},
              {"computed in", number(record.wall_s, 1) + " s"},
              {"made by", report::made_by()},
              {"command line", record.command_line}});
}

// Who the subjects are, and how far an experiment is: before anything else.
void add_banners(report::Page& page, const StudyRecord& record) {
  const Subjects who = subjects_of(record);
  if (who == Subjects::kSimulated) page.banner(report::kSimulatedBanner);
  if (who == Subjects::kMixed) {
    page.banner(fmt::format("Some of these subjects are simulated, no persons: {}.",
                            fmt::join(record.recorded->simulated, ", ")));
  }
  const std::string state = state_of(record);
  if (!state.empty() && !record.recorded->registered->registration.standing.incomplete.empty()) {
    page.banner("This experiment is not finished. " + state);
  } else if (!state.empty()) {
    page.facts({{"experiment", state}});
  }
}

const char* people_of(const StudyRecord& record) {
  const Subjects who = subjects_of(record);
  return !record.recorded              ? "Simulated subjects track"
         : who == Subjects::kPeople    ? "Recorded participants track"
         : who == Subjects::kSimulated ? "Simulated subjects, recorded live, track"
                                       : "Recorded participants and simulated subjects track";
}

void add_warnings(report::Page& page, const StudyRecord& record) {
  if (record.options.subjects == 1) {
    page.warning("One subject: there is no deviation, no test and no box plot.");
  } else if (record.options.subjects == 2) {
    page.warning("Two subjects: the t-test has one degree of freedom and proves little.");
  }
}

}  // namespace

report::Page study_report(const StudyRecord& record, const std::vector<report::Drawing>& drawings) {
  const Analysis& analysis = record.analysis;
  report::Page page(
      "Biodynamic feedthrough cancellation: the study",
      std::string(people_of(record)) +
          " a target on a stationary platform (A), on a moving one (B), and on "
          "a moving one where the motorised joystick cancels the biodynamic feedthrough (C), after "
          "Gillespie and Sövényi.");
  add_banners(page, record);
  add_lead_facts(page, record);
  add_warnings(page, record);
  const bool whole = conditions_run(record, kPaperConditions).size() == kPaperConditions.size();
  const auto show = [&](std::string_view prefix) {
    for (const report::Drawing& drawing : drawings) {
      if (drawing.name.starts_with(prefix)) page.figure(drawing);
    }
  };
  if (whole) {
    page.section("Tables I and II of the paper");
    add_paper_tables(page, record);
  }
  add_registered(page, record);
  add_participants(page, record);
  page.section("Identification");
  add_identification(page, record);
  show("fig04");
  show("fig06");
  page.section("Tracking");
  show("fig07");
  show("fig08");
  show("fig09");
  show("fig10");
  show("fig11");
  page.table(numbers_table(analysis));
  page.section("Crossover");
  show("fig12");
  show("fig13");
  add_open_loop(page, analysis);
  add_statistics(page, analysis);
  add_mitigations(page, record);
  add_cancellers(page, analysis);
  add_wrong_models(page, analysis);
  show("wrong_models");
  const auto drawing = [&drawings](const char* name) {
    const auto found = std::ranges::find(drawings, name, &report::Drawing::name);
    return found == drawings.end() ? nullptr : &*found;
  };
  add_simulated(page, record, drawing(kSimulatedFigure));
  add_diagnoses(page, record, drawing(kGainFigure));
  add_open_questions(page, record);
  return page;
}

}  // namespace stillhand::study
