// SPDX-License-Identifier: Apache-2.0
// What a person sees in the terminal at the end.
#include <fmt/format.h>

#include <cstdio>

#include "apps/close_the_loop/output.hpp"
#include "apps/libraries/report/text.hpp"
#include "apps/libraries/session/paper_table.hpp"

namespace stillhand::close_the_loop {
namespace {

using session::kMetrics;

std::string mean_text(const Estimate& estimate, const Measure& measure) {
  return report::number(estimate.mean, measure.decimals);
}

void print_measures(const Conditions& conditions) {
  fmt::print("\n{:<32}", "");
  for (const char* label : kConditions) fmt::print(" {:>8}", label);
  for (const auto& [from, to] : kSteps)
    fmt::print("   {:<24}", fmt::format("{} less {}", to, from));
  fmt::print("\n");
  for (std::size_t k = 0; k < kMeasures.size(); ++k) {
    const Measure& measure = kMeasures[k];
    fmt::print("{:<32}", measure.title);
    for (const char* label : kConditions) {
      fmt::print(" {:>8}", has(label, k) ? mean_text(measured(conditions, label, measure), measure)
                                         : std::string());
    }
    for (const auto& [from, to] : kSteps) {
      const Estimate difference = change(conditions, from, to, measure);
      fmt::print("   {:<24}", with_interval(difference, measure.decimals));
    }
    fmt::print("\n");
  }
  fmt::print("\n{:<32} {:<24} {:<24} {:<24} {}\n", "restored, (B - X)/(B - A) [%]", "C", "C'", "C+",
             "paper's C");
  for (std::size_t k = 0; k < kMetrics.size(); ++k) {
    fmt::print("{:<32}", kMeasures[k].title);
    for (const char* label : kCancelling) {
      fmt::print(" {:<24}", with_interval(restored(conditions, label, kMeasures[k]), 1, 100.0));
    }
    fmt::print(" {:.0f}\n", kMetrics[k].paper_restored_percent);
  }
}

}  // namespace

void print_result(const LoopRecord& record) {
  const LoopResult& result = record.result;
  print_measures(record.conditions);
  const Verdict& verdict = result.verdict();
  if (verdict.strongest() == nullptr) {
    fmt::print("{}\n", without_effect(verdict, verdict.body.options.least_force_n));
  }
  for (const Finding& finding : verdict.findings) {
    fmt::print("{}: {}{} in the {}, {} N{}: {}\n", finding.counts ? "missing" : "found",
               finding.kind, finding.channel.empty() ? "" : " (" + finding.channel + ")",
               finding.where, report::short_number(finding.explained_n),
               finding.counts ? "" : ", too small to count", finding.evidence);
  }
  std::printf(
      "prediction of the pegged force, held out: %.4f N before, %.4f N after, noise %.4f N\n",
      verdict.body.baseline_error.rmse, verdict.body.final_error.rmse,
      verdict.body.noise_floor.rmse);
  for (const Round& round : result.rounds) std::printf("C+: %s\n", round.outcome.c_str());
  if (const std::string kept = kept_text(record); !kept.empty()) fmt::print("{}\n", kept);
  if (record.truth) {
    std::printf("the sealed truth: %s%s%s; the verdict is %s\n", record.truth->kind.c_str(),
                record.truth->place.empty() ? "" : ", ", record.truth->place.c_str(),
                record.right() ? "right" : "wrong");
  }
}

}  // namespace stillhand::close_the_loop
