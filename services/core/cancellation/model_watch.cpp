// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/model_watch.hpp"

#include <cmath>

namespace stillhand::cancellation {
namespace {

// Eq. CC-20: several cycles of the slowest motion, 0.7 Hz.
constexpr double kBlock_s = 4.0;
constexpr Tick kBlock_ticks = ticks_in(kBlock_s);
// The band-pass forgets a step to 1 %.
constexpr Tick kSettle_ticks = ticks_in(3.0);
// Lost ticks over which the filters go on as if nothing were lost.
constexpr Tick kMostLost_ticks = 10;
// Less motion than this says nothing: a tenth of a millimetre RMS, as in CC-11.
constexpr double kLeastMotion_m2 = 1e-4 * 1e-4 * static_cast<double>(kBlock_ticks);

constexpr double kHour_s = 3600.0;

}  // namespace

ModelWatch::ModelWatch(double false_alarms_h, const HandCompliance& hand)
    : predicted_(hand), taken_(hand), chart_(kHour_s / kBlock_s / false_alarms_h) {}

void ModelWatch::begin_block() noexcept {
  collected_ = 0;
  rr_.fill(0.0);
  re_.fill(0.0);
}

void ModelWatch::interrupt() noexcept {
  predicted_.reset();
  taken_.reset();
  settle_left_ = kSettle_ticks;
  begin_block();
}

void ModelWatch::add(const ExplainedMotion::Pair& r, double e) noexcept {
  rr_[0] += r[0] * r[0];
  rr_[1] += r[0] * r[1];
  rr_[2] += r[1] * r[1];
  re_[0] += r[0] * e;
  re_[1] += r[1] * e;
  ++collected_;
}

std::optional<ModelWatch::Change> ModelWatch::end_block(Tick tick) noexcept {
  const double determinant = rr_[0] * rr_[2] - rr_[1] * rr_[1];
  const Eigen::Vector2d response{(rr_[2] * re_[0] - rr_[1] * re_[1]) / determinant,
                                 (rr_[0] * re_[1] - rr_[1] * re_[0]) / determinant};
  const bool moved = rr_[0] > kLeastMotion_m2;
  begin_block();
  if (!moved || !response.allFinite()) return std::nullopt;
  began_[static_cast<std::size_t>(blocks_++) % began_.size()] = tick - kBlock_ticks + 1;
  const statistics::ChangeChart::Step step = chart_.step(response);
  if (!step.changed) return std::nullopt;
  return Change{began_[static_cast<std::size_t>(blocks_ - step.ago) % began_.size()],
                step.by.norm()};
}

std::optional<ModelWatch::Change> ModelWatch::step(const Input& input) noexcept {
  const Tick apart = input.tick - last_tick_;
  last_tick_ = input.tick;
  const bool finite = std::isfinite(input.predicted_n) && std::isfinite(input.taken_n) &&
                      std::isfinite(input.theta_rad);
  if (apart < 1 || apart > kMostLost_ticks || !finite) interrupt();
  if (!finite) return std::nullopt;
  if (input.model != model_) {
    model_ = input.model;
    chart_.restart();
    interrupt();
  }
  const auto [r, moved_m] = predicted_.step(input.predicted_n, input.theta_rad);
  const double motors_m = taken_.step(input.taken_n, 0.0).r[0];
  if (settle_left_ > 0) --settle_left_;
  if (!input.acts || settle_left_ > 0) {
    begin_block();
    return std::nullopt;
  }
  // Eq. CC-20: the motor has taken its part away.
  add(r, moved_m + motors_m);
  return collected_ < kBlock_ticks ? std::nullopt : end_block(input.tick);
}

}  // namespace stillhand::cancellation
