// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/sensor_noise.hpp"

#include <cmath>

#include "services/core/signal/random.hpp"

namespace stillhand::rig {
namespace {

// For 128 layers: where the tail begins, and the area of a layer (Doornik 2005, table 1).
constexpr double kTailBegin = 3.442619855899;
constexpr double kLayerArea = 9.91256303526217e-3;

}  // namespace

SensorNoise::SensorNoise(std::uint64_t seed, std::uint64_t stream)
    : engine_(signal::seeded_engine(seed, stream)) {
  double height = std::exp(-0.5 * kTailBegin * kTailBegin);
  edge_[0] = kLayerArea / height;
  edge_[1] = kTailBegin;
  for (std::size_t i = 2; i < kLayers; ++i) {
    edge_[i] = std::sqrt(-2.0 * std::log(kLayerArea / edge_[i - 1] + height));
    height = std::exp(-0.5 * edge_[i] * edge_[i]);
  }
  edge_[kLayers] = 0.0;
  for (std::size_t i = 0; i < kLayers; ++i) ratio_[i] = edge_[i + 1] / edge_[i];
}

double SensorNoise::tail(bool negative) noexcept {
  double x = 0.0;
  double y = 0.0;
  do {
    x = std::log(unit(engine_())) / kTailBegin;
    y = std::log(unit(engine_()));
  } while (-2.0 * y < x * x);
  return negative ? x - kTailBegin : kTailBegin - x;
}

double SensorNoise::beyond_core(std::size_t layer, double u) noexcept {
  for (;;) {
    if (layer == 0) return tail(u < 0.0);
    const double x = u * edge_[layer];
    const double above = std::exp(-0.5 * (edge_[layer] * edge_[layer] - x * x));
    const double below = std::exp(-0.5 * (edge_[layer + 1] * edge_[layer + 1] - x * x));
    if (below + unit(engine_()) * (above - below) < 1.0) return x;
    const std::uint64_t bits = engine_();
    layer = bits & (kLayers - 1);
    u = 2.0 * unit(bits) - 1.0;
    if (std::abs(u) < ratio_[layer]) return u * edge_[layer];
  }
}

}  // namespace stillhand::rig
