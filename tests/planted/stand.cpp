// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/stand.hpp"

#include <algorithm>
#include <cmath>

#include "tests/planted/linear_fit.hpp"
#include "tests/planted/plant.hpp"

namespace stillhand::planted {

double strength_of(const Series& with, const Series& without) {
  Series difference(with.size());
  for (std::size_t i = 0; i < with.size(); ++i) difference[i] = with[i] - without[i];
  return spread_of(difference) / spread_of(without);
}

double evidence_of(double left, double snr_db, std::size_t samples) {
  return static_cast<double>(samples) * left * left * std::pow(10.0, snr_db / 10.0);
}

Stand::Stand(const Body& body, const Scene& scene) : body_(body), scene_(scene) {
  const Plant plain{.body = body};
  Motion motion = body_force(scene, plain);
  body_force_n_ = std::move(motion.force_n);
  plain_n_ = recorded_force(scene, plain, body_force_n_);
  rate_hz_ = scene.grid.rate_hz / static_cast<double>(scene.grid.per_sample);
  stride_ = std::max(1.0, std::round(rate_hz_ / 100.0));
  a_y_.resize(scene.grid.recorded);
  for (std::size_t n = 0; n < a_y_.size(); ++n) a_y_[n] = scene.of("a_y")[scene.grid.at(n)];
  reference_.force_rms_n = spread_of(plain_n_);
  reference_.acceleration_rms_m_s2 = spread_of(a_y_);
  reference_.seat_rms_m = motion.seat_rms_m;
  reference_.shoulder_rms_m = motion.shoulder_rms_m;
  reference_.grip_rms_m = motion.grip_rms_m;
}

Series Stand::force_n(const std::vector<SizedEffect>& effects, std::size_t but,
                      const Series& early_noise_n) const {
  Plant plant{.body = body_};
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (i != but) effects[i].effect.plant(effects[i].size, plant);
  }
  const bool moves_otherwise = plant.body_altered || !plant.drive.empty();
  return recorded_force(scene_, plant,
                        moves_otherwise ? body_force(scene_, plant).force_n : body_force_n_,
                        early_noise_n);
}

double Stand::strength_at(const Effect& effect, double size) const {
  return strength_of(force_n({{effect, size}}), plain_n_);
}

SizedEffect Stand::fit_size(Effect effect, double strength, Draw& draw) const {
  double low = 0.0;
  double high = 1.0;
  if (effect.any_size) low = high = draw.unit();
  const double at_low = strength_at(effect, low);
  if (low == high || at_low >= strength) return {std::move(effect), low, at_low};
  const double at_high = strength_at(effect, high);
  if (at_high <= strength) return {std::move(effect), high, at_high};
  double middle = 0.5;
  double reached = 0.0;
  for (int i = 0; i < 40; ++i) {
    middle = 0.5 * (low + high);
    reached = strength_at(effect, middle);
    if (std::abs(reached / strength - 1.0) < 0.002) break;
    (reached < strength ? low : high) = middle;
  }
  return {std::move(effect), middle, reached};
}

SizedEffect Stand::plant(Kind kind, double strength, double least_evidence, double snr_db,
                         Draw& draw) const {
  SizedEffect best;
  double best_miss = INFINITY;
  for (int attempt = 0; attempt < 12 && best_miss > 0.0; ++attempt) {
    SizedEffect now = fit_size(draw_effect(kind, scene_, body_, reference_, draw), strength, draw);
    const double off = std::abs(now.strength / strength - 1.0);
    double miss = now.effect.any_size || off < 0.01 ? 0.0 : off;
    if (miss == 0.0 && least_evidence > 0.0) {
      const double left = left_by_order_4(force_n({now}));
      miss = std::max(0.0, 1.0 - evidence_of(left, snr_db, plain_n_.size()) / least_evidence);
    }
    if (miss >= best_miss) continue;
    best_miss = miss;
    best = std::move(now);
  }
  best.left_by_order_4 = left_by_order_4(force_n({best}));
  best.evidence = evidence_of(best.left_by_order_4, snr_db, plain_n_.size());
  return best;
}

Series Stand::beyond_linear(const Series& force_n) const {
  const auto taps = static_cast<std::size_t>(std::round(2.0 * rate_hz_ / stride_));
  return beyond_impulse_response(a_y_, force_n, taps, static_cast<std::size_t>(stride_));
}

double Stand::irreducible(const Series& force_n) const {
  const Series left = beyond_linear(force_n);
  return left.empty() ? std::nan("") : spread_of(left) / spread_of(force_n);
}

double Stand::left_by_order_4(const Series& force_n) const {
  constexpr std::size_t kMostSamples = 100'000;  // 0.3 s of computing
  Series thin_a;
  Series thin_f;
  for (std::size_t n = 0; n < force_n.size(); n += static_cast<std::size_t>(stride_)) {
    thin_a.push_back(a_y_[n]);
    thin_f.push_back(force_n[n]);
  }
  if (thin_f.size() > kMostSamples) return std::nan("");
  // The first 3 s count nothing, as an effect that starts has transients of its own; poles that
  // forget within 10 s leave room for every planted mode.
  const double thin_hz = rate_hz_ / stride_;
  return left_by_difference_equation(thin_a, thin_f, 4, static_cast<std::size_t>(3.0 * thin_hz),
                                     10.0 * thin_hz) /
         spread_of(force_n);
}

}  // namespace stillhand::planted
