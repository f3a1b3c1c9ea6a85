// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "apps/diagnose/page/figures.hpp"
#include "apps/diagnose/page/questions.hpp"

namespace stillhand::diagnose {
namespace {

using report::Kind;
using report::Panel;
using report::Scale;
using report::Series;

constexpr std::size_t kMostQuestions = 12;
// [-] smaller ones would leave the others no room, and the plotter no ticks.
constexpr double kLeastDrawn = 1e-30;
constexpr double kOffset =
    0.14;  // of a place on the axis, so that two points don't hide each other

// Short enough for a place on the axis.
std::string tick_of(const diagnosis::Detection& detection) {
  constexpr std::size_t kLongest = 32;
  std::string text = detection.question + " " + detection.channel;
  if (const auto at = text.find("the body's output"); at != std::string::npos) {
    text.resize(at);  // it comes last
    text += 'y';
  }
  if (text.size() > kLongest) {
    text.resize(kLongest - 1);
    text += "…";
  }
  return text;
}

// Answers of one residual, apart by whether something is there.
struct Points {
  Series share;
  Series chance;
};

Points points_of(const std::vector<Answers>& all, diagnosis::Detection Answers::* which, bool found,
                 const char* label, report::Colour colour, double offset) {
  Series series{.label = label, .kind = Kind::kPoints, .colour = colour};
  series.point_size = found ? 1.5 : 0.7;
  series.show_in_legend = found;
  Points points{series, series};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const diagnosis::Detection& answer = all[i].*which;
    if (answer.found != found) continue;
    const double place = static_cast<double>(i + 1) + offset;
    points.share.x.push_back(place);
    points.chance.x.push_back(place);
    points.share.y.push_back(100.0 * std::max(answer.share, 0.0));
    points.chance.y.push_back(std::max(answer.p, kLeastDrawn));
  }
  return points;
}

}  // namespace

report::Figure figure_detections(const Evidence& evidence) {
  const std::vector<Answers> all = strongest_answers(evidence.found, kMostQuestions);
  Panel share;
  Panel chance;
  share.y = {.label = "share [%]", .low = 0.0};
  chance.y = {.label = "p (Holm)", .scale = Scale::kLogarithmic};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto place = static_cast<double>(i + 1);
    chance.x.ticks.push_back({place, tick_of(all[i].before)});
    share.x.ticks.push_back({place, " "});
  }
  share.x.low = chance.x.low = 0.4;
  share.x.high = chance.x.high = static_cast<double>(all.size()) + 0.6;
  const auto add = [&](diagnosis::Detection Answers::* which, const char* label,
                       report::Colour colour, double offset) {
    for (const bool found : {true, false}) {
      Points points = points_of(all, which, found, label, colour, offset);
      share.series.push_back(std::move(points.share));
      chance.series.push_back(std::move(points.chance));
    }
  };
  add(&Answers::before, "baseline's residual", kBefore, 0.0);
  if (!evidence.found.effects.empty()) {
    add(&Answers::after, "residual with the effects", kAfter, kOffset);
  }
  chance.legend = report::Legend::kNone;
  share.reference_lines = {{.at = 100.0 * diagnosis::kLeastShare, .label = "threshold"}};
  chance.reference_lines = {{.at = diagnosis::kSignificance, .label = "threshold"}};
  return {
      .name = "detections",
      .caption =
          "The questions that explain most of the residual. Above: share of its power on held-out "
          "blocks (negative ones drawn at 0). Below: probability of such a gain by chance, "
          "corrected for all questions after Holm (smaller ones drawn at 1e-30). A large mark is "
          "significant: its share is above the threshold, and its p below. y: the body's output.",
      .panels = {share, chance},
      .width_px = 980,
      .height_px = 560};
}

}  // namespace stillhand::diagnose
