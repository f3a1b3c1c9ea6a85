// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/session_figure.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/lab/summary_json.hpp"
#include "apps/libraries/report/plot/draw.hpp"

namespace stillhand::lab {
namespace {

using report::Colour;

constexpr double kForceExtent_n = 25.0;  // the motor's limit; more where the feedthrough has more
constexpr double kForceStep_n = 5.0;
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
std::string title_of(const session::TrialResult& trial, const session::SessionResult& result) {
  const std::string& rig_parts = result.rig_parts;
  const std::string title =
      name_in(result, trial) + (trial.label == session::Condition::kB ? ", moving" : ", cancelled");
  if (rig_parts.empty()) return title;
  const std::size_t at = rig_parts.find("simulated: ");
  return title + " (devices" + (at == std::string::npos ? "" : "; " + rig_parts.substr(at)) + ")";
}

double force_extent_n(const std::vector<const session::TrialResult*>& trials) {
  double extent_n = kForceExtent_n;
  for (const auto* trial : trials) {
    for (const double force_n : trial->excerpt.feedthrough_n) {
      if (std::isfinite(force_n)) extent_n = std::max(extent_n, std::abs(force_n));
    }
  }
  return kForceStep_n * std::ceil(extent_n / kForceStep_n);
}

// From where the model no longer held to the end.
std::optional<report::Series> without_model(const session::TrialResult& trial, double extent_n) {
  const std::vector<double>& time_s = trial.excerpt.time_s;
  if (!trial.model_lost_s || *trial.model_lost_s >= time_s.back()) return std::nullopt;
  const double since_s = std::max(*trial.model_lost_s, time_s.front());
  return report::Series{.label = "its model no longer holds",
                        .kind = report::Kind::kBand,
                        .colour = Colour::kWarning,
                        .x = {since_s, time_s.back()},
                        .y_low = {-extent_n, -extent_n},
                        .y_high = {extent_n, extent_n}};
}

report::Panel force_panel(const session::TrialResult& trial, const session::SessionResult& result,
                          double extent_n) {
  const session::Excerpt& excerpt = trial.excerpt;
  report::Panel out = panel(title_of(trial, result), "force [N]", extent_n);
  // Of a rig of devices nobody knows the feedthrough.
  const bool known = !excerpt.feedthrough_n.empty() && std::isfinite(excerpt.feedthrough_n.front());
  out.series = {
      {.label = "feedthrough",
       .colour = Colour::kMeasured,
       .x = excerpt.time_s,
       .y = excerpt.feedthrough_n},
      {.label = "motor", .colour = Colour::kModel, .x = excerpt.time_s, .y = excerpt.motor_n}};
  if (!known) out.series.erase(out.series.begin());
  if (auto band = without_model(trial, extent_n)) {
    out.series.insert(out.series.begin(), *std::move(band));
  }
  for (const auto& [label, miss] : result.disturbances) {
    const bool shown = miss.trial == trial.number && miss.trial_s >= excerpt.time_s.front() &&
                       miss.trial_s <= excerpt.time_s.back();
    if (!shown) continue;
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
  for (const session::TrialResult& trial : result.trials) {
    using enum session::Condition;
    if (trial.label == kB || trial.label == kC || trial.label == kCPlus) shown.push_back(&trial);
  }
  std::ranges::stable_sort(shown, {}, &session::TrialResult::label);
  if (shown.empty()) return {};
  report::Figure figure;
  figure.name = kSessionFigure;
  figure.caption =
      "12 s of each trial: its first, or those around the loss of its model. Above: the force that "
      "the body would put on a stick that is held (feedthrough), and the motor's. Below: target "
      "and "
      "cursor.";
  figure.columns = static_cast<int>(shown.size());
  figure.height_px = 520;
  const double extent_n = force_extent_n(shown);
  for (const auto* trial : shown) {
    figure.panels.push_back(force_panel(*trial, result, extent_n));
  }
  for (const auto* trial : shown) {
    figure.panels.push_back(hand_panel(*trial, trial->label == session::Condition::kB
                                                   ? Colour::kConditionB
                                                   : Colour::kConditionC));
  }
  return report::render({{figure}}, folder);
}

}  // namespace stillhand::lab
