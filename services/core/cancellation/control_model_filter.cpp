// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/control_model_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace stillhand::cancellation {
namespace {

template <typename Taps>
void copy(const std::vector<double>& from, Taps& to) {
  std::copy(from.begin(), from.end(), to.begin());
}

}  // namespace

ControlModel control_model(const signal::DifferenceModel& model) {
  ControlModel whole;
  whole.rate_hz = model.rate_hz;
  whole.denominator = model.denominator;
  whole.inputs = {{Channel::kAccelY, {}, model.numerator}};
  return whole;
}

const Hysteresis* hysteresis_of(const ControlModel& model, std::optional<std::size_t> path) {
  const auto found = std::ranges::find(model.hysteresis, path, &Hysteresis::path);
  return found == model.hysteresis.end() ? nullptr : &*found;
}

signal::DifferenceModel path_model(const ControlModel& model, const InputPath& input) {
  return {model.rate_hz, input.numerator, model.denominator};
}

ControlModelFilter::ControlModelFilter(const ControlModel& model,
                                       std::int64_t settle_ticks) noexcept
    : order_(model.denominator.size() - 1),
      output_(model.output),
      settle_ticks_(settle_ticks),
      loaded_(true) {
  copy(model.denominator, d_);
  for (const InputPath& input : model.inputs) {
    Input& to = inputs_[inputs_used_++];
    to.channel = static_cast<std::size_t>(input.channel);
    to.map = ValueTable(input.map);
    copy(input.numerator, to.c);
  }
  if (model.loop) {
    loop_ = true;
    of_output_ = model.loop->n.empty();
    copy(model.loop->e, e_);
    copy(model.loop->n, n_);
    copy(model.loop->m, m_);
    phi_ = ValueTable(model.loop->phi);
    phi_ticks_ = model.loop->ticks;
  }
  for (const DirectPath& path : model.paths) {
    const double blend = path.lag_s > 0.0 ? -std::expm1(-kControlPeriod_s / path.lag_s) : 1.0;
    const bool of_stick = path.channel == Channel::kTheta || path.channel == Channel::kOmega;
    paths_[paths_used_++] = {static_cast<std::size_t>(path.channel),
                             blend,
                             {},
                             ValueTable(path.map),
                             path.gain,
                             of_stick};
  }
  for (const Hysteresis& each : model.hysteresis) {
    (each.path ? paths_[*each.path].memory : spring_memory_) = HysteresisElement(each);
  }
  for (const Wave& wave : model.waves) {
    waves_[waves_used_++] = {wave.channel ? static_cast<std::size_t>(*wave.channel) : kChannels,
                             2.0 * std::numbers::pi * wave.frequency, wave.sine_n, wave.cosine_n};
  }
}

void ControlModelFilter::reset() noexcept {
  s_.fill(0.0);
  t_.fill(0.0);
  lagged_.fill(0.0);
  spring_memory_.reset();
  held_phi_ = 0.0;
  for (Path& path : paths_) path.memory.reset();
  at_rest_ = true;
}

double ControlModelFilter::body(const ChannelSample& sample, Tick tick) noexcept {
  std::array<double, kMostInputs> v{};
  for (std::size_t k = 0; k < inputs_used_; ++k) {
    v[k] = inputs_[k].map(sample[inputs_[k].channel]);
  }
  double y = inputs_[0].c[0] * v[0] + s_[0];
  for (std::size_t k = 1; k < inputs_used_; ++k) y += inputs_[k].c[0] * v[k];
  double phi = 0.0;
  if (loop_) {
    const double z = of_output_ ? y : n_[0] * v[0] + t_[0];
    if (tick % phi_ticks_ == 0) held_phi_ = phi_(spring_memory_.step(z));
    phi = held_phi_;
    y += e_[0] * phi;
    for (std::size_t i = 1; i <= order_; ++i) {
      t_[i - 1] = n_[i] * v[0] + m_[i] * phi - d_[i] * z + t_[i];
    }
  }
  for (std::size_t i = 1; i <= order_; ++i) {
    double next = inputs_[0].c[i] * v[0] - d_[i] * y + s_[i];
    for (std::size_t k = 1; k < inputs_used_; ++k) next += inputs_[k].c[i] * v[k];
    s_[i - 1] = next + e_[i] * phi;
  }
  return y;
}

ControlModelFilter::Force ControlModelFilter::step(const ChannelSample& sample,
                                                   Tick tick) noexcept {
  Force force{output_(body(sample, tick)), 0.0};
  for (std::size_t k = 0; k < paths_used_; ++k) {
    Path& path = paths_[k];
    lagged_[k] += (at_rest_ ? 1.0 : path.blend) * (sample[path.channel] - lagged_[k]);
    const double force_n = path.gain * path.map(path.memory.step(lagged_[k]));
    (path.of_stick ? force.beside_n : force.feedthrough_n) += force_n;
  }
  at_rest_ = false;
  for (std::size_t k = 0; k < waves_used_; ++k) {
    const Turning& wave = waves_[k];
    const double at = wave.channel < kChannels ? sample[wave.channel]
                                               : static_cast<double>(tick) * kControlPeriod_s;
    force.beside_n +=
        wave.sine_n * std::sin(wave.turn * at) + wave.cosine_n * std::cos(wave.turn * at);
  }
  return force;
}

}  // namespace stillhand::cancellation
