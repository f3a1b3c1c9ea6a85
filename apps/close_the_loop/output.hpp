// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "apps/close_the_loop/repair/repair.hpp"
#include "apps/close_the_loop/session/closed_loop.hpp"
#include "apps/close_the_loop/session/conditions.hpp"
#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/staged_folder.hpp"

namespace stillhand::close_the_loop {

inline constexpr const char* kVerdictFile = "verdict.json";
inline constexpr const char* kControlModelFile = "control_model.json";

/// The truth, when it is opened at the end.
struct Truth {
  std::string kind;
  std::string channel;
  std::string place;
  std::string numbers;                    ///< as one line for people
  double force_n = 0.0;                   ///< RMS force of an effect outside of the kinds
  std::optional<double> beyond_linear_n;  ///< RMS of what no linear model explains of it, Eq. RG-37

  /// Whether a kind of the diagnosis describes it.
  [[nodiscard]] bool outside() const;
  /// Kind, channel and place of the strongest finding; without an effect, no finding; outside of
  /// the kinds, "unexplained residual", or "nothing missing" if what no linear model explains is
  /// below detectable_n().
  [[nodiscard]] bool agrees_with(const Verdict& verdict) const;
};
/// Reads undeclared_effect.json.
Truth truth_of(const std::string& sealed_text);

/// What is written, besides the result.
struct LoopRecord {
  LoopOptions options;
  std::uint64_t undeclared_effect = 0;
  bool live = false;         ///< over DDS
  std::int64_t subject = 0;  ///< of the population under the seed; 0: the rig's default
  std::string command_line;
  LoopResult result;
  Conditions conditions;       ///< what tables and figures show
  LoopDecision decision;       ///< by the conditions: is C+ kept?
  RepairList repairs;          ///< what each effect is worth; empty: none counts
  std::optional<Truth> truth;  ///< empty: nothing was sealed

  /// Verdict and truth agree: METHOD, "Right".
  [[nodiscard]] bool right() const { return truth && truth->agrees_with(result.verdict()); }
};

/// verdict.json: kind, channel and findings, written before the truth is opened.
std::string verdict_json(const Verdict& verdict);
/// Parts of summary.json.
nlohmann::ordered_json prediction_json(const Verdict& verdict);
nlohmann::ordered_json latency_json(const std::optional<Latency>& latency);
nlohmann::ordered_json treatments_json(const ConvertedModel& control);
/// What the canceller does about each effect.  @param used  the model ran
report::Table treatment_table(const ConvertedModel& control, bool used);
/// summary.json, README "Files".
std::string summary_json(const LoopRecord& record);
/// Tables and verdict, to standard output.
void print_result(const LoopRecord& record);
/// One sentence on a verdict without an effect.  @param least_force_n  0: the output is no force
std::string without_effect(const Verdict& verdict, double least_force_n);
/// What became of C+, with the rows that decide, METHOD Eq. CL-10; empty: it is C'.
std::string kept_text(const LoopRecord& record);
/// "mean [low, high]" of an estimate, or the mean alone.
std::string with_interval(const Estimate& estimate, int decimals, double factor = 1.0);

/// A bar at the next place of the panel, with its interval where there is one.
void add_bar(report::Panel& panel, const std::string& label, report::Colour colour, double value,
             const std::optional<std::pair<double, double>>& interval95);

/// Every number of each condition, and what each restores of the paper's metrics.
report::Table measures_table(const Conditions& conditions);
report::Table restoration_table(const Conditions& conditions);
/// What C, C' and C+ leave, by cause (session, SN-8); none where a trial has no budget.
std::optional<report::Table> causes_table(const LoopResult& result);

/// report.html with its figures.
report::Page loop_page(const LoopRecord& record, const std::vector<report::Drawing>& drawings);
std::vector<report::Figure> loop_figures(const LoopRecord& record);

/// Every file that any run of the loop writes.
std::vector<std::string> every_name();

}  // namespace stillhand::close_the_loop
