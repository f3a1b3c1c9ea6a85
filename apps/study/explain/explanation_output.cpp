// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/explanation_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/libraries/report/plot/figure_table.hpp"

namespace stillhand::study {
namespace {

constexpr std::size_t kPairsPrinted = 6;

void print_hypothesis(const Hypothesis& one, double nothing) {
  fmt::print("{:<44} {:8.1f}   {:5.1f} {:5.1f} {:5.1f}   {:5.1f} {:5.1f} {:5.1f}\n", one.name,
             one.log_evidence - nothing, one.z[6], one.z[7], one.z[8], one.z[12], one.z[13],
             one.z[14]);
}

void print_spread(const Spread& spread) {
  fmt::print("\nCauses of the spread of B-C, on the paper's chain; SDs over the paper's\n");
  const auto line = [](const SpreadFit& fit) {
    fmt::print("{:<56} {:4.0f} %   {:.2f} {:.2f} {:.2f}\n", fit.name, 100.0 * fit.given,
               fit.over_paper[3], fit.over_paper[4], fit.over_paper[5]);
  };
  line(spread.chain);
  for (const SpreadFit& fit : spread.ranked) line(fit);
  fmt::print("On other subjects:\n");
  for (const SpreadJudged& one : spread.judged) line(one.fit);
}

void print_means(const Explanation& explanation) {
  const double nothing = explanation.single.front().log_evidence;
  fmt::print("\n{:<44} {:>8}   {:^17}   {:^17}\n", "", "log", "B-C means", "B-C SDs");
  fmt::print("{:<44} {:>8}   {:>5} {:>5} {:>5}   {:>5} {:>5} {:>5}\n", "cause", "evidence", "RMS",
             "dwell", "f_c", "RMS", "dwell", "f_c");
  auto single = explanation.single;
  std::ranges::stable_sort(single, std::ranges::greater{}, &Hypothesis::log_evidence);
  for (const Hypothesis& one : single) print_hypothesis(one, nothing);
  for (std::size_t i = 0; i < std::min(kPairsPrinted, explanation.pairs.size()); ++i) {
    print_hypothesis(explanation.pairs[i], nothing);
  }
  fmt::print("Means and SDs: simulated - paper, in the paper's standard errors.\n");
  const auto names = indistinguishable(explanation.all());
  if (!names.empty()) {
    fmt::print("The tables cannot tell apart: {}\n", fmt::join(names, ", "));
  }
  fmt::print("On other subjects, restored RMS, dwell, f_c (paper: 47, 32, 27 %):\n");
  for (const Judged& one : explanation.judged) {
    fmt::print("  {:<44} {:3.0f} {:3.0f} {:3.0f} %\n", one.name, 100.0 * one.restored[0],
               100.0 * one.restored[1], 100.0 * one.restored[2]);
  }
}

}  // namespace

void write_explanation(const Explanation& explanation, const std::string& command_line,
                       report::StagedFolder& folder) {
  const auto drawings = report::render(explanation_figures(explanation), folder.path());
  explanation_page(explanation, command_line, drawings).write(folder.path() / "report.html");
  folder.write("explanation.json", explanation_json(explanation));
  std::vector<std::string> own{"report.html", "explanation.json"};
  for (const auto& drawing : drawings) {
    for (std::string& name : report::figure_files(drawing.name)) own.push_back(std::move(name));
  }
  folder.publish(own);
}

void print_explanation(const Explanation& explanation) {
  if (!explanation.single.empty()) print_means(explanation);
  if (explanation.spread) print_spread(*explanation.spread);
}

}  // namespace stillhand::study
