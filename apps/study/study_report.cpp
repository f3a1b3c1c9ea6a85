// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study_report.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/report/text.hpp"
#include "apps/study/figures.hpp"
#include "services/statistics/power.hpp"
#include "version.hpp"

namespace stillhand::study {
namespace {

using report::Cell;
using report::Emphasis;
using report::number;
using report::short_number;
using session::kMetrics;

// The paper's p-values, Tables I and II.
constexpr std::array<double, kMetricCount> kPaperAToB{1.79e-9, 1.5e-12, 5.67e-7};
constexpr std::array<double, kMetricCount> kPaperBToC{4.05e-6, 4.07e-5, 0.0047};

int decimals(std::size_t metric) { return metric == 0 ? 1 : 2; }

double paper_value(std::size_t metric, char condition) {
  const session::Metric& what = kMetrics[metric];
  const double unit = metric == 0 ? kPaperUnit_mm : 1.0;
  return unit * (condition == 'A' ? what.paper_a : condition == 'B' ? what.paper_b : what.paper_c);
}

// Beyond a double's range a tail is 0, which no probability is.
std::string p_value(double p) { return p > 0.0 ? short_number(p) : "< 10⁻³⁰⁰"; }

std::string percent(double share) { return number(100.0 * share, 0) + " %"; }

const Comparison* find(const Analysis& analysis, char from, char to) {
  for (const Comparison& comparison : analysis.comparisons) {
    if (comparison.from == from && comparison.to == to) return &comparison;
  }
  return nullptr;
}

std::string mean_and_deviation(const MetricSample& sample, std::size_t metric) {
  std::string out = number(sample.mean, decimals(metric));
  if (sample.standard_deviation) {
    out += " ± " + number(*sample.standard_deviation, decimals(metric));
  }
  if (sample.known < sample.per_subject.size())
    out += " (n = " + std::to_string(sample.known) + ")";
  return out;
}

// Tables I and II of the paper: two conditions, their difference, its significance.
report::Table paper_table(const Analysis& analysis, char from, char to, const char* title,
                          const std::array<double, kMetricCount>& paper_p) {
  report::Table table;
  table.caption = title;
  const std::string letters = {from, ',', ' ', to};
  table.header = {"metric", std::string(1, from), std::string(1, to), "change [95 % CI]", "p",
                  "g_z",    "paper " + letters,   "paper p"};
  const Comparison* comparison = find(analysis, from, to);
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    std::vector<Cell> row{kMetrics[k].title, mean_and_deviation(analysis.conditions.at(from)[k], k),
                          mean_and_deviation(analysis.conditions.at(to)[k], k)};
    const auto& test = comparison->tests[k];
    if (test) {
      row.emplace_back(number(test->mean_difference, decimals(k)) + " [" +
                       number(test->ci_low, decimals(k)) + ", " +
                       number(test->ci_high, decimals(k)) + "]");
      row.emplace_back(p_value(test->p), test->p < 0.01 ? Emphasis::kStrong : Emphasis::kNone);
      row.emplace_back(test->hedges_gz ? number(*test->hedges_gz, 2) : "–");
    } else {
      row.insert(row.end(), 3, Cell("–"));
    }
    row.emplace_back(
        number(paper_value(k, from), decimals(k)) + ", " + number(paper_value(k, to), decimals(k)),
        Emphasis::kFaint);
    row.emplace_back(short_number(paper_p[k]), Emphasis::kFaint);
    table.rows.push_back(row);
  }
  return table;
}

report::Table calibration_table(const Analysis& analysis, bool is_default) {
  report::Table table;
  table.caption =
      is_default
          ? "How close the population comes to the paper. A and B were calibrated on, RMS error "
            "through a unit that was itself inferred from the dwell ratios; C was not."
          : "How close this study comes to the paper. Its population or its lengths are not "
            "those that A and B were calibrated with.";
  table.header = {"metric", "condition", "study", "paper", "study / paper", "role"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    for (const char condition : {'A', 'B', 'C'}) {
      const double mean = analysis.conditions.at(condition)[k].mean;
      const double paper = paper_value(k, condition);
      const double ratio = mean / paper;
      const bool calibrated = is_default && condition != 'C';
      table.rows.push_back(
          {kMetrics[k].title, std::string(1, condition), number(mean, decimals(k)),
           number(paper, decimals(k)),
           Cell(number(ratio, 2),
                calibrated && std::abs(ratio - 1.0) > 0.1 ? Emphasis::kBad : Emphasis::kNone),
           calibrated   ? "calibrated"
           : is_default ? "predicted"
                        : "–"});
    }
  }
  const double ours = analysis.conditions.at('B')[0].mean / analysis.conditions.at('A')[0].mean;
  const double theirs = kMetrics[0].paper_b / kMetrics[0].paper_a;
  table.rows.push_back({"RMS error, B / A (no unit needed)", "", number(ours, 2), number(theirs, 2),
                        number(ours / theirs, 2), is_default ? "calibrated" : "–"});
  return table;
}

report::Table restoration_table(const Analysis& analysis) {
  report::Table table;
  table.caption = "Restoration (B − C)/(B − A) of the means: 100 % is as on firm ground.";
  table.header = {"metric", "study", "paper"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    table.rows.push_back(
        {kMetrics[k].title, percent(analysis.restoration[k].value_or(NAN)),
         Cell(percent(kMetrics[k].paper_restored_percent / 100.0), Emphasis::kFaint)});
  }
  return table;
}

void add_outcome(report::Page& page, const Analysis& analysis) {
  const double restored = analysis.restoration[0].value_or(NAN);
  const double paper = kMetrics[0].paper_restored_percent / 100.0;
  std::string text = "The motor cancels " + percent(analysis.cancelled_share.at('C').mean) +
                     " of the feedthrough force, and " + percent(restored) +
                     " of the RMS error comes back. ";
  if (restored > paper) {
    text +=
        "That is more than the paper's: between peg and tracking these subjects differ in one "
        "thing "
        "only, the stiffness of a co-contracted arm. Real ones also change posture and grip over "
        "minutes, adapt to the motor, and are disturbed by the motion itself, not only through the "
        "hand.";
  } else {
    text +=
        "That is less than the paper's: this population's tracking arms differ more from the "
        "idle ones that were identified, or its feedthrough from the model.";
  }
  page.paragraph(text);
}

void add_effect(report::Table& table, const char* name, const statistics::MultivariateTest& test) {
  table.rows.push_back(
      {name, short_number(test.wilks_lambda), number(test.wilks.f, 2),
       number(test.wilks.numerator_df, 0) + ", " + number(test.wilks.denominator_df, 1),
       Cell(p_value(test.wilks.p), test.wilks.p < 0.01 ? Emphasis::kStrong : Emphasis::kNone)});
}

void add_manova(report::Page& page, const MultivariateResult& result, const char* caption) {
  if (!result.manova) {
    page.paragraph(std::string(caption) + " No test: " + result.reason + ".");
    return;
  }
  report::Table table;
  table.caption = caption;
  table.header = {"effect", "Wilks' Λ", "F (Rao)", "degrees of freedom", "p"};
  add_effect(table, "condition", result.manova->condition);
  add_effect(table, "subject", result.manova->subject);
  if (result.manova->interaction) add_effect(table, "interaction", *result.manova->interaction);
  page.table(table);
}

void add_statistics(report::Page& page, const Analysis& analysis) {
  page.section("Multivariate analysis of variance");
  add_manova(
      page, analysis.main_effects,
      "All three metrics, one trial a cell: main effects only, an interaction cannot be told "
      "from the error.");
  add_manova(page, analysis.thirds,
             "RMS error and dwell ratio with the thirds of each trial (whole windows of 10 s) as "
             "replicates, so that the "
             "interaction of condition and subject can be tested. Thirds of one trial are not "
             "independent, so these p-values are too small. Crossover needs a whole trial.");
  const Comparison* test = find(analysis, 'B', 'C');
  if (test == nullptr) return;
  report::Table table;
  table.caption =
      "Subjects needed to find the change from B to C at α = 0.01, were its size that of "
      "this study.";
  table.header = {"metric", "effect size d_z", "for power 0.8", "for power 0.95"};
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    if (!test->tests[k]) continue;
    const double dz = test->tests[k]->cohen_dz;
    if (std::abs(dz) > 100.0 || std::abs(dz) < 0.01) continue;
    table.rows.push_back({kMetrics[k].title, number(dz, 2),
                          std::to_string(statistics::subjects_for_power(dz, 0.8, 0.01)),
                          std::to_string(statistics::subjects_for_power(dz, 0.95, 0.01))});
  }
  if (!table.rows.empty()) page.table(table);
}

void add_open_loop(report::Page& page, const Analysis& analysis) {
  report::Table table;
  table.caption =
      "Open loop at the target's fifteen frequencies, all subjects, in dB: the paper's estimate "
      "(mean of "
      "20 "
      "log|X_p/X_e|), the one through the reference (|mean X_p/X_r| / |mean X_e/X_r|), which the "
      "remnant does not bias, and the median share of what is not the target's response (remnant, "
      "in B and C also the platform's motion) of the error's power at the line.";
  table.header = {"f [Hz]"};
  std::map<char, std::vector<PooledLine>> shown;
  for (const auto& [condition, lines] : analysis.open_loop) {
    if (condition > 'C') continue;  // the others are in open_loop.csv
    shown[condition] = lines;
    const std::string letter(1, condition);
    table.header.insert(table.header.end(),
                        {letter + " paper", letter + " ref.", letter + " rem."});
  }
  if (shown.empty()) return;
  for (std::size_t line = 0; line < signal::kReferenceLines; ++line) {
    std::vector<Cell> row{number(shown.begin()->second[line].frequency_hz, 3)};
    for (const auto& [condition, lines] : shown) {
      row.emplace_back(number(lines[line].paper_db, 1));
      row.emplace_back(number(lines[line].reference_db, 1));
      row.emplace_back(percent(lines[line].remnant_share));
    }
    table.rows.push_back(row);
  }
  page.table(table);
}

void add_crossover(report::Page& page, const Analysis& analysis) {
  report::Table table;
  table.caption =
      "Crossover by the paper's line through eleven points, and through the reference "
      "with the remnant's power taken off (identification, Eq. ID-15).";
  table.header = {"condition", "paper's line [Hz]", "through the reference [Hz]"};
  for (const auto& [condition, metrics] : analysis.conditions) {
    table.rows.push_back({label_of(condition), mean_and_deviation(metrics[2], 2),
                          mean_and_deviation(analysis.crossover_reference_hz.at(condition), 2)});
  }
  page.table(table);
}

void add_mitigations(report::Page& page, const StudyRecord& record) {
  const Analysis& analysis = record.analysis;
  if (conditions_run(record, "DEF").empty() || !analysis.conditions.contains('B')) return;
  page.section("Other mitigations");
  page.paragraph(
      "What the paper names as future work, all with the motor off. D takes the predicted "
      "displacement off the command instead of pushing the hand; it knows an average person's arm "
      "only. E adds " +
      short_number(record.options.damped_stick_n_s_m) +
      " N s/m to the stick. F rests the forearm on a pad of " +
      number(record.options.arm_rest_stiffness_n_m, 0) + " N/m and " +
      number(record.options.arm_rest_damping_n_s_m, 0) +
      " N s/m (assumed values) that moves with the platform.");
  report::Table table;
  table.caption = "Against B, mean ± SD; restoration as (B − X)/(B − A).";
  table.header = {"condition", "RMS error [mm]", "dwell ratio",
                  "f_c [Hz]",  "RMS restored",   "p (RMS, against B)"};
  for (const auto& [condition, metrics] : analysis.conditions) {
    const Comparison* test = find(analysis, 'B', condition);
    std::string restored = "–";
    if (condition > 'B' && analysis.conditions.contains('A')) {
      const double a = analysis.conditions.at('A')[0].mean;
      const double b = analysis.conditions.at('B')[0].mean;
      restored = percent((b - metrics[0].mean) / (b - a));
    }
    table.rows.push_back(
        {label_of(condition), mean_and_deviation(metrics[0], 0), mean_and_deviation(metrics[1], 1),
         mean_and_deviation(metrics[2], 2), restored,
         test != nullptr && test->tests[0] ? p_value(test->tests[0]->p) : std::string("–")});
  }
  page.table(table);
}

void add_wrong_models(report::Page& page, const Analysis& analysis) {
  if (analysis.wrong.empty()) return;
  page.section("A model that is not the subject's");
  report::Table table;
  table.caption =
      "Condition C with the wrong model, same motion and target; share of the own "
      "model's gain in RMS error that survives, over subjects whose own model gains.";
  table.header = {"model", "RMS error [mm]", "surviving, median", "worst subject", "subjects"};
  for (const auto& [which, wrong] : analysis.wrong) {
    std::vector<double> shares;
    std::copy_if(wrong.surviving_share.begin(), wrong.surviving_share.end(),
                 std::back_inserter(shares), [](double share) { return std::isfinite(share); });
    const bool any = !shares.empty();
    table.rows.push_back(
        {which == 'O' ? "another subject's" : "mean of all others",
         mean_and_deviation(wrong.metrics[0], 0), percent(any ? statistics::median(shares) : NAN),
         percent(any ? *std::min_element(shares.begin(), shares.end()) : NAN),
         std::to_string(shares.size()) + " of " + std::to_string(wrong.surviving_share.size())});
  }
  page.table(table);
  page.paragraph(
      "A share above 100 % is no error: every subject's own model is that of the idle arm, and the "
      "tracking arm is stiffer, so a model that happens to be stronger can fit the tracking arm "
      "better than the own.");
}

void add_identification(report::Page& page, const StudyRecord& record) {
  const std::int64_t unusable = record.analysis.refined_used;
  page.paragraph(
      "Each subject's model is the paper's: recorded, low-passed at 10 Hz, 50 Hz, four zeros and "
      "four poles by least squares. Beside it stands the same model fitted on its free-run error, "
      "which output noise does not bias. " +
      (unusable == 0 ? std::string("Every one of the paper's fits was stable and cancelled.")
                     : std::to_string(unusable) + " of " + std::to_string(record.options.subjects) +
                           " of the paper's fits were unstable or could not be carried to 1 kHz; "
                           "there the free-run fit cancelled instead (models.csv)."));
}

void add_open_questions(report::Page& page, const StudyRecord& record) {
  page.section("What the paper leaves open");
  // Sentences go over several lines: no comma is missing.
  // NOLINTBEGIN(bugprone-suspicious-missing-comma)
  page.list(
      {"The RMS error has no unit. With a box of ±15 mm and a Gaussian error the dwell ratios give "
       "23.3, 51.3 and 37.6 mm for A, B, C: 5.8, 5.3 and 5.4 mm a unit. This report uses 5.5 mm "
       "and "
       "shows the ratio B/A, which needs none.",
       "Eq. 8 has no unit either: the target's scale is a setting of the display, chosen so that "
       "condition A has a dwell ratio near 0.48.",
       "The multipliers are called relatively prime; 87 = 3·29 and 310 = 2·5·31 share factors. "
       "They "
       "are used as printed; the display offers 89 and 311.",
       "The tracking motion is 0.7 to 2 Hz \"as mentioned above\", where 0.7 to 4 Hz is mentioned: "
       "0.7 to 4 Hz here for identification, 0.7 to 2 Hz for tracking.",
       "An interaction of condition and subject cannot be tested with one trial a cell. Main "
       "effects "
       "are tested so; the interaction with thirds of a trial as replicates.",
       "X_p/X_e is biased by the remnant in a closed loop: both estimates are given.",
       record.options.protocol.trial_s == 180.0
           ? "Trials last the paper's 180 s, so the fifteen frequencies are the printed ones."
           : "Trials of " + short_number(record.options.protocol.trial_s) +
                 " s cannot hold whole cycles of 1/180 Hz: the fifteen frequencies sit on "
                 "harmonics of the trial's own length."});
  // NOLINTEND(bugprone-suspicious-missing-comma)
}

void add_lead_facts(report::Page& page, const StudyRecord& record) {
  const StudyOptions& options = record.options;
  page.facts({{"subjects", std::to_string(options.subjects)},
              {"seed", std::to_string(options.seed)},
              {"trial", short_number(options.protocol.trial_s) + " s"},
              {"pegged trial", short_number(options.protocol.identify_s) + " s"},
              {"computed in", number(record.wall_s, 1) + " s"},
              {"version", kVersion},
              {"command line", record.command_line}});
  if (options.subjects == 1) {
    page.warning("One subject: no deviation, no test and no box can be given.");
  } else if (options.subjects == 2) {
    page.warning("Two subjects: a t-test with one degree of freedom means little.");
  }
}

}  // namespace

report::Page study_report(const StudyRecord& record, const std::vector<report::Drawing>& drawings) {
  const Analysis& analysis = record.analysis;
  report::Page page(
      "Biodynamic feedthrough cancellation: the study",
      "Simulated subjects track a target on a stationary platform (A), on a moving one "
      "(B), and on a moving one with the motorised joystick cancelling what the body "
      "feeds through (C), after Gillespie and Sövényi.");
  add_lead_facts(page, record);
  const bool whole = conditions_run(record, "ABC") == "ABC";
  const auto show = [&](std::string_view prefix) {
    for (const report::Drawing& drawing : drawings) {
      if (drawing.name.starts_with(prefix)) page.figure(drawing);
    }
  };
  if (whole) {
    page.section("Tables I and II of the paper");
    page.table(
        paper_table(analysis, 'A', 'B',
                    "Table I: the platform begins to move. Mean ± SD over the "
                    "subjects; g_z is Hedges' corrected effect size of the differences; p is "
                    "not adjusted for three metrics.",
                    kPaperAToB));
    page.table(paper_table(analysis, 'B', 'C',
                           "Table II: the motor begins to cancel. Columns as in Table I.",
                           kPaperBToC));
    page.table(restoration_table(analysis));
    add_outcome(page, analysis);
    page.table(calibration_table(analysis, is_calibrated(record.options)));
  }
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
  page.section("Crossover");
  show("fig12");
  show("fig13");
  add_crossover(page, analysis);
  add_open_loop(page, analysis);
  add_statistics(page, analysis);
  add_mitigations(page, record);
  add_wrong_models(page, analysis);
  show("wrong_models");
  add_open_questions(page, record);
  return page;
}

}  // namespace stillhand::study
