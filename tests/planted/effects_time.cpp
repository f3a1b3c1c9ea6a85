// SPDX-License-Identifier: Apache-2.0
// What depends on time alone: tone, drift, bursts; and the choice among all kinds.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/planted/effect.hpp"

namespace stillhand::planted {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Adds a function of time, its mean over the recording left out; size 1: as large as the force.
Effect added(Kind kind, const Scene& scene, const Reference& reference,
             std::function<double(double)> at, std::vector<Parameter> fixed) {
  Series once(scene.grid.recorded);
  for (std::size_t n = 0; n < once.size(); ++n) once[n] = at(scene.grid.time_s(scene.grid.at(n)));
  const double mean = mean_of(once);
  const double largest_n = reference.force_rms_n / spread_of(once);
  Effect out;
  out.kind = kind;
  out.plant = [=](double size, Plant& plant) {
    plant.added.push_back([=](const Scene& where, Series& f) {
      for (std::size_t i = 0; i < f.size(); ++i) {
        f[i] += largest_n * size * (at(where.grid.time_s(i)) - mean);
      }
    });
  };
  out.parameters = [=](double size) {
    std::vector<Parameter> all{{"amplitude", largest_n * size, "N"}};
    all.insert(all.end(), fixed.begin(), fixed.end());
    return all;
  };
  return out;
}

Effect tone(const Scene& scene, const Reference& reference, double length_s, Draw& draw) {
  const double rate_hz = scene.grid.rate_hz / static_cast<double>(scene.grid.per_sample);
  double tone_hz = 0.0;
  bool clear = false;
  while (!clear) {  // 4 resolutions from every line of a channel
    tone_hz = draw.log_uniform(0.3, std::min(25.0, 0.4 * rate_hz));
    clear = std::none_of(scene.periodic_hz.begin(), scene.periodic_hz.end(), [&](double line_hz) {
      return std::abs(line_hz - tone_hz) < std::max(0.02, 1.0 / length_s);
    });
  }
  const double phase_rad = draw.uniform(0.0, kTwoPi);
  Effect out = added(Kind::kTone, scene, reference,
                     [=](double t_s) { return std::sin(kTwoPi * tone_hz * t_s + phase_rad); },
                     {{"frequency", tone_hz, "Hz"}, {"phase", phase_rad, "rad"}});
  out.variant = "one sine";
  return out;
}

Effect drift(const Scene& scene, const Reference& reference, double length_s, Draw& draw) {
  const double sign = draw.sign();
  const std::size_t pick = draw.index(3);
  if (pick == 0) {
    Effect out = added(Kind::kDrift, scene, reference,
                       [=](double t_s) { return sign * t_s / length_s; }, {});
    out.variant = "ramp";
    return out;
  }
  if (pick == 1) {
    const double tau_s = length_s * draw.uniform(0.08, 0.5);
    Effect out = added(Kind::kDrift, scene, reference,
                       [=](double t_s) { return -sign * std::exp(-std::max(0.0, t_s) / tau_s); },
                       {{"time_constant", tau_s, "s"}});
    out.variant = "exponential";
    return out;
  }
  const double cycles = draw.uniform(0.5, 0.8);
  Effect out = added(Kind::kDrift, scene, reference,
                     [=](double t_s) { return sign * std::cos(kTwoPi * cycles * t_s / length_s); },
                     {{"cycles", cycles, "-"}});
  out.variant = "half a cosine";
  return out;
}

struct Burst {
  double at_s, long_s, height, ring_hz;
};

double burst_at(const std::vector<Burst>& bursts, bool ringing, double t_s) {
  double sum = 0.0;
  for (const Burst& burst : bursts) {
    const double x = (t_s - burst.at_s) / burst.long_s;
    if (x <= 0.0 || x >= 1.0) continue;
    const double window = std::sin(std::numbers::pi * x);
    sum += burst.height *
           (ringing ? std::exp(-3.0 * x) * std::sin(kTwoPi * burst.ring_hz * x * burst.long_s)
                    : window * window);
  }
  return sum;
}

Effect transients(const Scene& scene, const Reference& reference, double length_s, Draw& draw) {
  const std::size_t count = 2 + draw.index(5);
  const bool ringing = draw.chance(0.4);
  std::vector<Burst> bursts;
  std::vector<Parameter> fixed;
  for (std::size_t i = 0; i < count; ++i) {
    // One in each share of the recording: isolated.
    const double share_s = length_s / static_cast<double>(count);
    const double at_s = share_s * (static_cast<double>(i) + draw.uniform(0.1, 0.85));
    bursts.push_back({at_s, draw.uniform(0.1, 0.5), draw.sign() * draw.uniform(0.6, 1.4),
                      draw.uniform(5.0, 12.0)});
    fixed.push_back({"time_" + std::to_string(i + 1), at_s, "s"});
    fixed.push_back({"duration_" + std::to_string(i + 1), bursts.back().long_s, "s"});
  }
  Effect out = added(
      Kind::kTransients, scene, reference,
      [=](double t_s) { return burst_at(bursts, ringing, t_s); }, fixed);
  out.variant = ringing ? "ringing knocks" : "smooth jerks";
  return out;
}

}  // namespace

Effect draw_time_effect(Kind kind, const Scene& scene, const Reference& reference, Draw& draw) {
  const double length_s = scene.grid.time_s(scene.grid.at(scene.grid.recorded));
  if (kind == Kind::kTone) return tone(scene, reference, length_s, draw);
  if (kind == Kind::kDrift) return drift(scene, reference, length_s, draw);
  return transients(scene, reference, length_s, draw);
}

Effect draw_effect(Kind kind, const Scene& scene, const Body& body, const Reference& reference,
                   Draw& draw) {
  switch (kind) {
    case Kind::kDelay:
    case Kind::kClockDrift:
      return draw_clock_effect(kind, draw);
    case Kind::kResonance:
      return draw_resonance(scene, body, draw);
    case Kind::kNonlinearStiffness:
    case Kind::kAsymmetry:
      return draw_spring_effect(kind, reference, draw);
    case Kind::kHysteresis:
      return draw.chance(0.35) ? draw_channel_effect(kind, scene, reference, draw)
                               : draw_spring_effect(kind, reference, draw);
    case Kind::kDeadZone:
      return draw.chance(0.2) ? draw_spring_effect(kind, reference, draw)
                              : draw_range_effect(kind, reference, draw);
    case Kind::kOutputSaturation:
    case Kind::kInputSaturation:
      return draw_range_effect(kind, reference, draw);
    case Kind::kTimeVaryingGain:
    case Kind::kRegimeChange:
      return draw_gain_effect(kind, scene, draw);
    case Kind::kCoupledInput:
    case Kind::kCoulombFriction:
    case Kind::kPositionRipple:
    case Kind::kBilinear:
      return draw_channel_effect(kind, scene, reference, draw);
    case Kind::kTone:
    case Kind::kDrift:
    case Kind::kTransients:
      break;
  }
  return draw_time_effect(kind, scene, reference, draw);
}

}  // namespace stillhand::planted
