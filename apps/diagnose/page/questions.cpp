// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/questions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillhand::diagnose {

std::vector<Answers> strongest_answers(const diagnosis::Diagnosis& found, std::size_t count) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Answers> all;
  for (const diagnosis::Detection& each : found.before.detections) {
    const auto at = std::ranges::find_if(found.after.detections, [&](const auto& other) {
      return other.question == each.question && other.channel == each.channel;
    });
    const bool asked = at != found.after.detections.end();
    all.push_back({each, asked ? *at
                               : diagnosis::Detection{each.question, each.channel, kNone, kNone,
                                                      false, each.channels}});
  }
  const auto share = [](const Answers& answers) {
    return std::fmax(answers.before.share, answers.after.share);  // passes over a NaN
  };
  std::ranges::stable_sort(all, std::ranges::greater(), share);
  if (all.size() > count) all.resize(count);
  return all;
}

}  // namespace stillhand::diagnose
