// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/control_laws.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::close_the_loop {
namespace {

using cancellation::Channel;

constexpr std::size_t kTableValues = 129;

}  // namespace

std::optional<Channel> channel_of(std::string_view name) {
  for (std::size_t i = 0; i < cancellation::kChannels; ++i) {
    if (cancellation::kChannelFacts[i].name == name) return static_cast<Channel>(i);
  }
  return std::nullopt;
}

cancellation::ValueMap table(double low, double high, const std::function<double(double)>& map) {
  cancellation::ValueMap out{low, high, {}};
  for (std::size_t i = 0; i < kTableValues; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kTableValues - 1);
    out.values.push_back(map(low + share * (high - low)));
  }
  return out;
}

cancellation::DirectPath friction_path(Channel channel, double transition, double gain) {
  constexpr double kLeastTransition = 0.05;  // [rad/s] 4096 counts and 100 Hz: 0.15 rad/s a count
  const double used = std::max(transition, kLeastTransition);
  const double wide = 8.0 * used;
  return {channel, 0.0, table(-wide, wide, [&](double v) { return std::tanh(v / used); }), gain};
}

void add_waves(const diagnosis::Effect& effect, std::optional<Channel> channel, double frequency,
               double sign, cancellation::ControlModel& model) {
  for (std::size_t h = 0; 2 * h + 1 < effect.coefficients.size(); ++h) {
    model.waves.push_back({channel, static_cast<double>(h + 1) * frequency,
                           sign * effect.coefficients[2 * h],
                           sign * effect.coefficients[2 * h + 1]});
  }
}

}  // namespace stillhand::close_the_loop
