// SPDX-License-Identifier: Apache-2.0
// What a person sees in the terminal at the end.
#include <fmt/format.h>

#include <cstdio>

#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/repair_output.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::close_the_loop {
void print_result(const LoopRecord& record) {
  const LoopResult& result = record.result;
  fmt::print("\n{}\n{}", report::in_plain_text(measures_table(record.conditions)),
             report::in_plain_text(restoration_table(record.conditions)));
  if (const auto causes = causes_table(result)) {
    fmt::print("{}\n", report::in_plain_text(*causes));
  }
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
  if (!record.repairs.effects.empty()) {
    fmt::print("\n{}{}\n", report::in_plain_text(repair_table(record.repairs)),
               repair_check(record.repairs));
  }
  if (record.truth) {
    std::printf("the sealed truth: %s%s%s; the verdict is %s\n", record.truth->kind.c_str(),
                record.truth->place.empty() ? "" : ", ", record.truth->place.c_str(),
                record.right() ? "right" : "wrong");
  }
}

}  // namespace stillhand::close_the_loop
