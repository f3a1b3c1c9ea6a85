// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/recording.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "tests/planted/stand.hpp"

namespace stillhand::planted {
namespace {

/// Streams of one seed: adding an effect changes neither body nor ride nor noise.
enum Stream : std::uint64_t { kBody = 1, kRide, kChannels, kNoise, kLoss, kEffects = 100 };
constexpr std::uint64_t kAgain = 500;
constexpr std::uint64_t kStreamsARound = 1000;

void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

double wanted(const Spec& spec, std::size_t i) {
  return spec.strengths[std::min(i, spec.strengths.size() - 1)];
}

void check(const Spec& spec) {
  require(spec.length_s >= 5.0 && spec.rate_hz >= 20.0, "want at least 5 s at 20 Hz");
  require(!spec.strengths.empty(), "at least one strength");
  for (const double strength : spec.strengths) require(strength > 0.0, "strength must be positive");
  require(std::set(spec.kinds.begin(), spec.kinds.end()).size() == spec.kinds.size(),
          "each kind at most once");
}

Recording recorded(const Scene& scene, const Series& force_n, const std::vector<bool>& lost) {
  Recording out;
  const Grid& grid = scene.grid;
  out.rate_hz = grid.rate_hz / static_cast<double>(grid.per_sample);
  for (std::size_t n = 0; n < grid.recorded; ++n) {
    if (!lost[n]) out.time_s.push_back(static_cast<double>(n) / out.rate_hz);
  }
  const auto add = [&](const std::string& name, const std::string& unit, auto&& value_at) {
    out.names.push_back(name);
    out.units.push_back(unit);
    Series& column = out.columns.emplace_back();
    column.reserve(out.time_s.size());
    for (std::size_t n = 0; n < grid.recorded; ++n) {
      if (!lost[n]) column.push_back(value_at(n));
    }
  };
  for (const Signal& signal : scene.signals) {
    add(signal.name, signal.unit, [&](std::size_t n) { return signal.values[grid.at(n)]; });
  }
  add("f", "N", [&](std::size_t n) { return force_n[n]; });
  return out;
}

double correlation_of(const Series& a, const Series& b) {
  const double both = spread_of(a) * spread_of(b);
  if (both == 0.0 || a.empty()) return 0.0;
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return std::abs(sum / static_cast<double>(a.size()) - mean_of(a) * mean_of(b)) / both;
}

/// Fills in `overlap`; a contribution that is linear but for 2 % of the force overlaps with
/// nothing.
void find_overlaps(const Stand& stand, const std::vector<Series>& contributions,
                   std::vector<PlantedEffect>& effects) {
  if (effects.size() < 2) return;
  std::vector<Series> beyond;
  for (const Series& one : contributions) beyond.push_back(stand.beyond_linear(one));
  const double least = 0.02 * spread_of(stand.plain_n());
  for (std::size_t i = 0; i < effects.size(); ++i) {
    for (std::size_t j = 0; j < effects.size(); ++j) {
      if (i == j || spread_of(beyond[i]) < least || spread_of(beyond[j]) < least) continue;
      effects[i].overlap = std::max(effects[i].overlap, correlation_of(beyond[i], beyond[j]));
    }
  }
}

std::vector<PlantedEffect> told(const Stand& stand, const std::vector<SizedEffect>& sized,
                                const Spec& spec, const Series& force_n) {
  std::vector<PlantedEffect> out;
  std::vector<Series> contributions;
  for (std::size_t i = 0; i < sized.size(); ++i) {
    const Effect& effect = sized[i].effect;
    PlantedEffect one;
    one.kind = effect.kind;
    one.variant = effect.variant;
    one.channels = effect.channels;
    one.also = effect.also;
    one.parameters = effect.parameters(sized[i].size);
    one.strength = sized[i].strength;
    one.wanted_strength = wanted(spec, i);
    one.left_by_order_4 = sized[i].left_by_order_4;
    one.evidence = sized[i].evidence;
    Series difference = stand.force_n(sized, i);
    for (std::size_t n = 0; n < difference.size(); ++n) difference[n] -= force_n[n];
    one.marginal = spread_of(difference) / spread_of(stand.plain_n());
    out.push_back(std::move(one));
    contributions.push_back(std::move(difference));
  }
  find_overlaps(stand, contributions, out);
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.marginal > b.marginal; });
  return out;
}

/// Adds noise before or after the reading; returns what it comes to.
double add_noise(const Stand& stand, const std::vector<SizedEffect>& sized, const Series& noise_n,
                 Series& force_n) {
  const bool early = std::any_of(sized.begin(), sized.end(),
                                 [](const SizedEffect& one) { return one.effect.reads_noise; });
  const Series clean_n = force_n;
  if (early) {
    force_n = stand.force_n(sized, Stand::kNoneLeftOut, noise_n);
  } else {
    for (std::size_t n = 0; n < force_n.size(); ++n) force_n[n] += noise_n[n];
  }
  Series difference(force_n.size());
  for (std::size_t n = 0; n < force_n.size(); ++n) difference[n] = force_n[n] - clean_n[n];
  return spread_of(difference);
}

/// Noise and lost rows, and what the label says of them.
Losses disturb(std::uint64_t seed, std::uint64_t streams, const Spec& spec, const Stand& stand,
               const std::vector<SizedEffect>& sized, Series& force_n, Truth& truth) {
  truth.snr_db = spec.snr_db;
  Draw noise_draw(seed, streams + kNoise);
  const Noise noise =
      draw_noise(spec.noise, force_n.size(), spec.rate_hz,
                 truth.force_rms_n * std::pow(10.0, -spec.snr_db / 20.0), noise_draw);
  truth.noise_rms_n = add_noise(stand, sized, noise.values, force_n);
  Draw loss_draw(seed, streams + kLoss);
  const Losses losses =
      draw_losses(spec.gaps, spec.single_rows, force_n.size(), spec.rate_hz, loss_draw);
  truth.noise = noise.about;
  truth.losses = losses.about;
  truth.length_s = spec.length_s;
  truth.rate_hz = spec.rate_hz;
  return losses;
}

/// The body and its effects on another ride.
Recording again(std::uint64_t seed, std::uint64_t streams, Spec spec, const Body& body,
                const std::vector<SizedEffect>& sized, double first_force_rms_n) {
  if (spec.again_length_s > 0.0) spec.length_s = spec.again_length_s;
  if (spec.again_rate_hz > 0.0) spec.rate_hz = spec.again_rate_hz;
  if (spec.again_excitation) spec.excitation = spec.again_excitation;
  Draw ride_draw(seed, streams + kRide);
  Draw channel_draw(seed, streams + kChannels);
  const Excitation excitation =
      spec.excitation ? *spec.excitation : draw_excitation(ride_draw, spec.length_s, spec.rate_hz);
  const Scene scene = draw_scene(channel_draw, spec.length_s, spec.rate_hz, excitation);
  const Stand stand(body, scene);
  Series force_n = stand.force_n(sized);
  Truth truth;
  truth.force_rms_n = spec.again_excitation ? first_force_rms_n : spread_of(force_n);
  const Losses losses = disturb(seed, streams, spec, stand, sized, force_n, truth);
  return recorded(scene, force_n, losses.lost);
}

/// One body on one ride; `round` counts those that were tried before.
Draft draw_once(std::uint64_t seed, std::uint64_t round, const Spec& spec) {
  const std::uint64_t streams = round * kStreamsARound;
  Draw body_draw(seed, streams + kBody);
  Draw ride_draw(seed, streams + kRide);
  Draw channel_draw(seed, streams + kChannels);
  const Body body = draw_body(body_draw);
  const Excitation excitation =
      spec.excitation ? *spec.excitation : draw_excitation(ride_draw, spec.length_s, spec.rate_hz);
  const Scene scene = draw_scene(channel_draw, spec.length_s, spec.rate_hz, excitation);
  const Stand stand(body, scene);
  std::vector<SizedEffect> sized;
  for (std::size_t i = 0; i < spec.kinds.size(); ++i) {
    Draw effect_draw(seed, streams + kEffects + static_cast<std::uint64_t>(spec.kinds[i]));
    sized.push_back(
        stand.plant(spec.kinds[i], wanted(spec, i), spec.least_evidence, spec.snr_db, effect_draw));
  }
  Series force_n = stand.force_n(sized);
  Draft out;
  Truth& truth = out.truth;
  truth.seed = seed;
  truth.effects = told(stand, sized, spec, force_n);
  truth.strength = strength_of(force_n, stand.plain_n());
  truth.irreducible = stand.irreducible(force_n);
  truth.left_by_order_4 = stand.left_by_order_4(force_n);
  truth.evidence = evidence_of(truth.left_by_order_4, spec.snr_db, force_n.size());
  truth.force_rms_n = spread_of(force_n);
  truth.body = body;
  truth.figures = figures_of(body);
  truth.excitation = excitation;
  const Losses losses = disturb(seed, streams, spec, stand, sized, force_n, truth);
  out.recording = recorded(scene, force_n, losses.lost);
  if (spec.twice) out.again = again(seed, streams + kAgain, spec, body, sized, truth.force_rms_n);
  return out;
}

/// 1 and more: every effect shows clearly enough and by itself.
double clarity_of(const Truth& truth, double least_evidence) {
  constexpr double kMostOverlap = 0.7;  // half of the one's power is the other's
  double least = INFINITY;
  for (const PlantedEffect& effect : truth.effects) {
    least = std::min(least, effect.evidence / least_evidence);
    if (effect.overlap > kMostOverlap) least = std::min(least, 1.0 - effect.overlap);
  }
  return least;
}

}  // namespace

Draft draw(std::uint64_t seed, const Spec& spec) {
  check(spec);
  Draft best = draw_once(seed, 0, spec);
  if (!(spec.least_evidence > 0.0)) return best;
  constexpr std::uint64_t kMostRounds = 10;
  double clarity = clarity_of(best.truth, spec.least_evidence);
  for (std::uint64_t round = 1; round < kMostRounds && clarity < 1.0; ++round) {
    Draft next = draw_once(seed, round, spec);
    const double next_clarity = clarity_of(next.truth, spec.least_evidence);
    if (next_clarity <= clarity) continue;
    clarity = next_clarity;
    best = std::move(next);
  }
  return best;
}

}  // namespace stillhand::planted
