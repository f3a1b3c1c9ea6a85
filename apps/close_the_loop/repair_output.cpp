// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/repair_output.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/close_the_loop/output.hpp"
#include "apps/libraries/report/or_null.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::close_the_loop {
namespace {

using nlohmann::ordered_json;
using report::or_null;

constexpr int kDecimals = 2;

ordered_json mm_json(const Estimate& value) {
  return {{"mean", or_null(value.mean)}, {"interval95", or_null(value.interval95)}};
}

ordered_json worth_json(const Worth& worth) {
  ordered_json json{{"kind", worth.kind},
                    {"channel", or_null(worth.channel)},
                    {"where", worth.where},
                    {"advice", worth.advice()},
                    {"why_not", or_null(worth.why_not)}};
  if (!worth.why_not.empty()) return json;
  json["rms_error_mm"] = {{"left", mm_json(worth.left_mm)},
                          {"cancelled", worth.is_cancelled ? mm_json(worth.cancelled_mm) : nullptr},
                          {"mended", mm_json(worth.mended_mm)}};
  json["change_mm"] = {
      {"cancelled", worth.is_cancelled ? mm_json(worth.by_cancelling_mm) : nullptr},
      {"mended", mm_json(worth.by_mending_mm)}};
  return json;
}

std::string name_of(const Worth& worth) {
  return worth.kind + (worth.channel.empty() ? "" : " (" + worth.channel + ")");
}

void add_reduction(report::Panel& panel, const std::string& label, const Estimate& change,
                   report::Colour colour) {
  auto interval95 = change.interval95;
  if (interval95) interval95 = {-interval95->second, -interval95->first};
  add_bar(panel, label, colour, -change.mean, interval95);
}

}  // namespace

ordered_json repair_json(const RepairList& list) {
  ordered_json json{{"effects", ordered_json::array()},
                    {"modelled_mm", or_null(list.modelled_mm)},
                    {"measured_mm", or_null(list.measured_mm)},
                    {"intervals_of", "the person's model"}};
  for (const Worth& each : list.effects) json["effects"].push_back(worth_json(each));
  return json;
}

report::Table repair_table(const RepairList& list) {
  report::Table table;
  table.caption =
      "Mend, cancel or leave: the tracking error [mm RMS] that this person's own model predicts, "
      "and its change with 95 %; what is most worth mending comes first";
  table.header = {"effect", "left", "cancelled", "mended", "cancelling", "mending", "advice"};
  using enum report::Align;
  table.align = {kLeft, kRight, kRight, kRight, kRight, kRight, kLeft};
  for (const Worth& each : list.effects) {
    const std::string name = name_of(each) + ", " + each.where;
    if (!each.why_not.empty()) {
      table.rows.push_back({name, "", "", "", "", "", each.why_not});
      continue;
    }
    const auto mm = [](const Estimate& value) { return report::number(value.mean, kDecimals); };
    const auto change = [](const Estimate& value) { return with_interval(value, kDecimals); };
    table.rows.push_back({name, mm(each.left_mm), each.is_cancelled ? mm(each.cancelled_mm) : "–",
                          mm(each.mended_mm),
                          each.is_cancelled ? change(each.by_cancelling_mm) : "–",
                          change(each.by_mending_mm), each.advice()});
  }
  return table;
}

report::Figure repair_figure(const RepairList& list) {
  report::Figure figure;
  figure.name = "repair";
  figure.caption =
      "What each way takes off the tracking error, with 95 %, by this person's own model. For the "
      "rig these intervals are too narrow.";
  figure.columns = 1;
  figure.height_px = 320;
  report::Panel panel;
  panel.title = "reduction of the tracking error [mm RMS]";
  panel.legend = report::Legend::kNone;
  panel.x.ticks = {};
  for (const Worth& each : list.effects) {
    if (!each.why_not.empty()) continue;
    if (each.is_cancelled) {
      add_reduction(panel, name_of(each) + ": cancelled", each.by_cancelling_mm,
                    report::Colour::kConditionCPlus);
    }
    add_reduction(panel, name_of(each) + ": mended", each.by_mending_mm,
                  report::Colour::kConditionA);
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

std::string repair_check(const RepairList& list) {
  return fmt::format(
      "The model that predicts this gives {} mm for C', where {} mm were measured. The intervals "
      "are those of this model, and too narrow for the rig.",
      report::number(list.modelled_mm, 1), report::number(list.measured_mm, 1));
}

}  // namespace stillhand::close_the_loop
