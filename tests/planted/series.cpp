// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/series.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace stillhand::planted {
namespace {

constexpr std::uint64_t kPlanStream = 7;

std::optional<NoiseShape> noise_of(std::string_view name) {
  for (std::size_t i = 0; i < kNoiseNames.size(); ++i) {
    if (kNoiseNames[i] == name) return static_cast<NoiseShape>(i);
  }
  return std::nullopt;
}

std::vector<std::string> all_kinds() {
  std::vector<std::string> out(kKindNames.begin(), kKindNames.end());
  out.emplace_back("none");
  return out;
}

/// Nothing planted, but everything that has been mistaken for an effect.
void trouble(Spec& spec, Draw& draw) {
  const double pick = draw.unit();
  if (pick < 0.25) return;  // plain white noise
  if (pick < 0.45) {
    spec.noise = NoiseShape::kLowPass;
  } else if (pick < 0.55) {
    spec.noise = NoiseShape::kPink;
  } else if (pick < 0.65) {
    spec.noise = NoiseShape::kHeavyTailed;
  } else if (pick < 0.75) {
    spec.noise = NoiseShape::kUneven;
  } else if (pick < 0.85) {
    spec.snr_db = draw.uniform(0.0, 10.0);
  } else {
    spec.gaps = draw.chance(0.7);
    spec.single_rows = !spec.gaps || draw.chance(0.5);
    if (draw.chance(0.3)) spec.noise = NoiseShape::kLowPass;
  }
}

}  // namespace

void SeriesPlan::check() const {
  for (const std::string& kind : kinds) {
    if (kind != "none" && !kind_of(kind)) throw std::invalid_argument("no kind called " + kind);
  }
  if (!noise.empty() && !noise_of(noise)) throw std::invalid_argument("no noise called " + noise);
  if (strengths.empty() || snrs_db.empty()) throw std::invalid_argument("an empty list");
  if (together < 1 || together > kKindNames.size()) {
    throw std::invalid_argument("--together: want 1 to " + std::to_string(kKindNames.size()));
  }
}

std::pair<std::uint64_t, Spec> SeriesPlan::at(std::size_t i) const {
  const std::vector<std::string> names = kinds.empty() ? all_kinds() : kinds;
  Spec spec;
  spec.length_s = length_s;
  spec.rate_hz = rate_hz;
  spec.twice = twice;
  spec.again_length_s = again_length_s;
  spec.again_rate_hz = again_rate_hz;
  spec.least_evidence = least_evidence;
  const std::size_t round = i / names.size();
  spec.strengths = {strengths[round % strengths.size()]};
  spec.snr_db = snrs_db[round / strengths.size() % snrs_db.size()];
  spec.gaps = spec.single_rows = gaps;
  const std::uint64_t own_seed = seed * 1'000'003u + i;
  Draw draw(own_seed, kPlanStream);
  const std::string& name = names[i % names.size()];
  if (const auto kind = kind_of(name)) {
    spec.kinds.push_back(*kind);
    while (spec.kinds.size() < together) {
      const auto more = static_cast<Kind>(draw.index(kKindNames.size()));
      if (std::find(spec.kinds.begin(), spec.kinds.end(), more) != spec.kinds.end()) continue;
      spec.kinds.push_back(more);
      spec.strengths.push_back(strengths[draw.index(strengths.size())]);
    }
  } else if (noise.empty()) {
    trouble(spec, draw);
  }
  if (!noise.empty()) spec.noise = *noise_of(noise);
  return {own_seed, spec};
}

}  // namespace stillhand::planted
