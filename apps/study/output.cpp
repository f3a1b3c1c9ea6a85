// SPDX-License-Identifier: Apache-2.0
#include "apps/study/output.hpp"

#include <cstdio>
#include <string>
#include <vector>

#include "apps/report/plot/draw.hpp"
#include "apps/study/figures.hpp"
#include "apps/study/study_report.hpp"
#include "services/rig/sealed_file.hpp"

namespace stillhand::study {
namespace {

// Every file that any study writes.
std::vector<std::string> every_name() {
  std::vector<std::string> names{"report.html",   "summary.json",   "metrics.csv",
                                 "subjects.csv",  "models.csv",     "moving_averages.csv",
                                 "open_loop.csv", rig::kSealedFile, rig::kCommitmentFile};
  for (const char* figure : kFigureNames) {
    for (const char* ending : {".svg", ".png"}) names.push_back(std::string(figure) + ending);
  }
  return names;
}

}  // namespace

void write_study(const StudyRecord& record, report::StagedFolder& folder) {
  for (const CsvFile& file : csv_files(record)) folder.write(file.name, file.text);
  const auto drawings = report::render(study_figures(record), folder.path());
  study_report(record, drawings).write(folder.path() / "report.html");
  folder.write("summary.json", summary_json(record));
  if (!record.sealed.empty()) {
    folder.write(rig::kCommitmentFile, rig::digest_line(record.sealed, rig::kSealedFile));
    folder.write(rig::kSealedFile, record.sealed);
  }
  folder.publish(every_name());
}

void print_study(const StudyRecord& record) {
  const Analysis& analysis = record.analysis;
  std::printf("\n%-22s", "mean of the subjects");
  for (const auto& entry : analysis.conditions) std::printf(" %9c", entry.first);
  std::printf("   %9s   %s\n", "restored", "paper: A, B, C, restored");
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    const session::Metric& metric = session::kMetrics[k];
    std::printf("%-22s", metric.title);
    for (const auto& [condition, metrics] : analysis.conditions) {
      std::printf(" %9.3f", metrics[k].mean);
    }
    if (analysis.restoration[k]) {
      std::printf("   %7.0f %%", 100.0 * *analysis.restoration[k]);
    } else {
      std::printf("   %9s", "-");
    }
    const double unit = k == 0 ? kPaperUnit_mm : 1.0;
    std::printf("   %.2f, %.2f, %.2f, %.0f %%\n", unit * metric.paper_a, unit * metric.paper_b,
                unit * metric.paper_c, metric.paper_restored_percent);
  }
  std::printf("The paper's RMS error has no unit: taken as %.1f mm a unit.%s\n", kPaperUnit_mm,
              is_calibrated(record.options)
                  ? " A and B were calibrated on, C is a prediction."
                  : " Not the population and lengths that A and B were calibrated with.");
  for (const Comparison& comparison : analysis.comparisons) {
    std::printf("paired t-test %c-%c, p:", comparison.from, comparison.to);
    for (const auto& test : comparison.tests) {
      if (!test) {
        std::printf(" -");
      } else if (test->p > 0.0) {
        std::printf(" %.3g", test->p);
      } else {
        std::printf(" <1e-300");
      }
    }
    std::printf("\n");
  }
  if (analysis.main_effects.manova) {
    const auto& manova = *analysis.main_effects.manova;
    std::printf(
        "MANOVA, main effects: condition Wilks %.3g (p %.3g), subject Wilks %.3g (p %.3g)\n",
        manova.condition.wilks_lambda, manova.condition.wilks.p, manova.subject.wilks_lambda,
        manova.subject.wilks.p);
  }
}

}  // namespace stillhand::study
