// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "apps/diagnose/page/figures.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::ChannelCoherence;
using diagnosis::CoherenceResult;
using report::Colour;
using report::Kind;
using report::Panel;
using report::Scale;
using report::Series;

constexpr double kCoherenceOffset = 0.14;  // of a place, so that two points do not hide each other

// Channels, then inputs.
std::vector<const ChannelCoherence*> all_of(const CoherenceResult& result) {
  std::vector<const ChannelCoherence*> all;
  for (const ChannelCoherence& each : result.partial) all.push_back(&each);
  for (const ChannelCoherence& each : result.ordinary) all.push_back(&each);
  return all;
}

Series highest_series(const CoherenceResult& result, const char* label, Colour colour,
                      double offset) {
  Series series{.label = label, .kind = Kind::kPoints, .colour = colour};
  double place = 1.0 + offset;
  for (const ChannelCoherence* each : all_of(result)) {
    series.x.push_back(place);
    series.y.push_back(each->highest);
    place += 1.0;
  }
  return series;
}

Panel by_channel(const CoherenceResult& before, const CoherenceResult* after) {
  Panel panel;
  panel.y = {.label = "highest coherence [-]", .low = 0.0, .high = 1.0};
  const std::vector<const ChannelCoherence*> all = all_of(before);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool input = i >= before.partial.size();
    panel.x.ticks.push_back(
        {static_cast<double>(i + 1), all[i]->channel + (input ? " (input)" : "")});
  }
  const auto partial = static_cast<double>(before.partial.size());
  const auto count = static_cast<double>(all.size());
  panel.x.low = 0.4;
  panel.x.high = count + 0.6;
  Series threshold{.label = "threshold", .kind = Kind::kDashedLine, .colour = Colour::kNeutral};
  const double between = partial + 0.5;
  threshold.x = {between, count + 0.6};
  threshold.y = {before.ordinary_threshold, before.ordinary_threshold};
  if (!before.partial.empty()) {
    threshold.x.insert(threshold.x.begin(), {0.4, between});
    threshold.y.insert(threshold.y.begin(), {before.partial_threshold, before.partial_threshold});
  }
  panel.series.push_back(threshold);
  panel.series.push_back(highest_series(before, "baseline's residual", kBefore, 0.0));
  if (after != nullptr) {
    panel.series.push_back(
        highest_series(*after, "residual with the effects", kAfter, kCoherenceOffset));
  }
  return panel;
}

// Over frequency, of the channel that has the highest.
Panel over_frequency(const CoherenceResult& before, const CoherenceResult* after) {
  const auto strongest = static_cast<std::size_t>(
      std::ranges::max_element(before.partial, {}, &ChannelCoherence::highest) -
      before.partial.begin());
  Panel panel;
  panel.x = {.label = "frequency [Hz]", .scale = Scale::kLogarithmic};
  panel.y = {.label = "coherence with " + before.partial[strongest].channel + " [-]",
             .low = 0.0,
             .high = 1.0};
  const auto add = [&](const CoherenceResult& result, Colour colour, double width_px) {
    panel.series.push_back({.label = "",
                            .kind = Kind::kLine,
                            .colour = colour,
                            .x = result.frequency_hz,
                            .y = result.partial[strongest].coherence,
                            .line_width_px = width_px});
  };
  add(before, kBefore, 1.6);
  if (after != nullptr) add(*after, kAfter, 1.8);
  panel.x.low = before.frequency_hz.front();
  panel.x.high = before.frequency_hz.back();
  panel.legend = report::Legend::kNone;
  panel.reference_lines = {{.at = before.partial_threshold, .label = "threshold"}};
  return panel;
}

}  // namespace

report::Figure figure_coherence(const Evidence& evidence) {
  const diagnosis::Diagnosis& found = evidence.found;
  const CoherenceResult& before = found.before.coherence;
  const CoherenceResult* after = nullptr;
  if (!found.effects.empty() && found.after.coherence.partial.size() == before.partial.size() &&
      found.after.coherence.independent_averages > 0.0) {
    after = &found.after.coherence;
  }
  std::vector<Panel> panels{by_channel(before, after)};
  if (!before.partial.empty()) panels.push_back(over_frequency(before, after));
  const bool two = panels.size() > 1;
  const int height_px = two ? 520 : 300;
  return {.name = "partial_coherence",
          .caption =
              std::string("Coherence of the residual with each input, and with every other channel "
                          "after the inputs are removed from both. First panel: the highest value "
                          "of each channel. ") +
              (two ? "Second panel: the channel with the highest value, over frequency. " : "") +
              "Threshold: chance exceeds it in 1 % of records, corrected for all frequencies and "
              "channels, with " +
              report::number(before.independent_averages, 0) +
              " independent averages. A value above it shows that a linear path exists, not how "
              "much the path matters. The verdict does not use it.",
          .panels = std::move(panels),
          .width_px = 980,
          .height_px = height_px};
}

}  // namespace stillhand::diagnose
