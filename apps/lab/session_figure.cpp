// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/session_figure.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/report/plot/draw.hpp"

namespace stillhand::lab {
namespace {

using report::Colour;

constexpr double kForceExtent_n = 25.0;  // the motor's limit
constexpr double kHandExtent_mm = 200.0;

report::Panel panel(std::string title, std::string unit, double extent) {
  report::Panel panel;
  panel.title = std::move(title);
  panel.x.label = "time [s]";
  panel.y.label = std::move(unit);
  panel.y.low = -extent;
  panel.y.high = extent;
  return panel;
}

// A picture is shown without its page: it says of which parts the rig was.
std::string title_of(const session::TrialResult& trial, const std::string& rig_parts) {
  const std::string title = std::string(session::name_of(trial.label)) +
                            (trial.label == session::Condition::kB ? ", moving" : ", cancelled");
  if (rig_parts.empty()) return title;
  const std::size_t at = rig_parts.find("simulated: ");
  return title + " (devices" + (at == std::string::npos ? "" : "; " + rig_parts.substr(at)) + ")";
}

report::Panel force_panel(const session::TrialResult& trial, const session::SessionResult& result) {
  const session::Excerpt& excerpt = trial.excerpt;
  report::Panel out = panel(title_of(trial, result.rig_parts), "force [N]", kForceExtent_n);
  // Of a rig of devices nobody knows the feedthrough.
  const bool known = !excerpt.feedthrough_n.empty() && std::isfinite(excerpt.feedthrough_n.front());
  out.series = {
      {.label = "feedthrough",
       .colour = Colour::kMeasured,
       .x = excerpt.time_s,
       .y = excerpt.feedthrough_n},
      {.label = "motor", .colour = Colour::kModel, .x = excerpt.time_s, .y = excerpt.motor_n}};
  if (!known) out.series.erase(out.series.begin());
  for (const auto& [label, miss] : result.disturbances) {
    if (label != trial.label || miss.trial_s < 0.0 || miss.trial_s > excerpt.time_s.back())
      continue;
    out.reference_lines.push_back(
        {report::Direction::kVertical, miss.trial_s, miss.process + " late", Colour::kWarning});
  }
  return out;
}

report::Panel hand_panel(const session::TrialResult& trial, Colour colour) {
  const session::Excerpt& excerpt = trial.excerpt;
  report::Panel out = panel("", "position [mm]", kHandExtent_mm);
  out.series = {
      {.label = "target", .colour = Colour::kTarget, .x = excerpt.time_s, .y = excerpt.target_mm},
      {.label = "cursor", .colour = colour, .x = excerpt.time_s, .y = excerpt.cursor_mm}};
  return out;
}

}  // namespace

std::vector<report::Drawing> draw_session(const session::SessionResult& result,
                                          const std::filesystem::path& folder) {
  std::vector<const session::TrialResult*> shown;
  for (const auto label :
       {session::Condition::kB, session::Condition::kC, session::Condition::kCPlus}) {
    const auto trial = std::ranges::find(result.trials, label, &session::TrialResult::label);
    if (trial != result.trials.end()) shown.push_back(&*trial);
  }
  if (shown.empty()) return {};
  report::Figure figure;
  figure.name = kSessionFigure;
  figure.caption =
      "The first 12 s of each trial. Above: the force that the body would put on a stick that is "
      "held "
      "(feedthrough), and the motor's. Below: target and cursor.";
  figure.columns = static_cast<int>(shown.size());
  figure.height_px = 520;
  for (const auto* trial : shown) figure.panels.push_back(force_panel(*trial, result));
  for (const auto* trial : shown) {
    figure.panels.push_back(hand_panel(*trial, trial->label == session::Condition::kB
                                                   ? Colour::kConditionB
                                                   : Colour::kConditionC));
  }
  return report::render({{figure}}, folder);
}

}  // namespace stillhand::lab
