// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/detection_json.hpp"

#include <nlohmann/json.hpp>

namespace stillhand::diagnose {
namespace {

using diagnosis::ChannelCoherence;
using nlohmann::ordered_json;

ordered_json questions_json(const std::vector<diagnosis::Detection>& detections) {
  ordered_json all = ordered_json::array();
  for (const diagnosis::Detection& each : detections) {
    all.push_back({{"question", each.question},
                   {"about", each.channel},
                   {"channels", each.channels},
                   {"share", each.share},
                   {"p", each.p},
                   {"found", each.found}});
  }
  return all;
}

ordered_json channels_json(const std::vector<ChannelCoherence>& channels) {
  ordered_json all = ordered_json::array();
  for (const ChannelCoherence& each : channels) {
    all.push_back({{"channel", each.channel},
                   {"highest", each.highest},
                   {"at_hz", each.highest_hz},
                   {"p", each.p},
                   {"significant", each.significant}});
  }
  return all;
}

ordered_json coherence_json(const diagnosis::CoherenceResult& coherence) {
  if (coherence.independent_averages <= 0.0) return nullptr;
  return {{"independent_averages", coherence.independent_averages},
          {"significance", diagnosis::CoherenceResult::kSignificance},
          {"partial_threshold", coherence.partial_threshold},
          {"partial", channels_json(coherence.partial)},
          {"ordinary_threshold", coherence.ordinary_threshold},
          {"ordinary", channels_json(coherence.ordinary)}};
}

ordered_json group_json(const diagnosis::LineGroup& group) {
  if (group.empty()) return nullptr;
  return {{"lines", group.frequency_hz.size()}, {"share", group.share}, {"p", group.p}};
}

ordered_json lines_json(const diagnosis::DetectionLines& lines) {
  const auto& repeats = lines.repeats;
  return {{"period_samples", lines.periodicity.period},
          {"periods", repeats.periods},
          {"first_period_left_out", repeats.first_left_out},
          {"input_not_repeating", lines.periodicity.deviation},
          {"fundamental_hz", lines.fundamental_hz},
          {"noise_rms", repeats.rms},
          {"noise_ci95", {repeats.low, repeats.high}},
          {"excited", group_json(lines.excited)},
          {"odd", group_json(lines.odd)},
          {"even", group_json(lines.even)},
          {"odd_or_even", group_json(lines.odd_or_even)}};
}

}  // namespace

ordered_json detection_json(const diagnosis::DetectionResult& result) {
  return {{"questions", questions_json(result.detections)},
          {"autocorrelation_outside_bound", result.whiteness.share_outside},
          {"rms_largest_over_median", result.spread.largest_ratio},
          {"coherence", coherence_json(result.coherence)},
          {"lines", result.lines ? lines_json(*result.lines) : ordered_json(nullptr)}};
}

}  // namespace stillhand::diagnose
