// SPDX-License-Identifier: Apache-2.0
#include "services/core/human_operator/pointer_operator.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/tick.hpp"

namespace stillhand::human_operator {
namespace {

// Close to critically damped: the arm follows the pointer without swinging past it.
constexpr double kDampingRatio = 0.9;
// Wider than any screen.
constexpr double kFarthest_m = 1.0;

const PointerOperator::Config& checked(const PointerOperator::Config& config) {
  validate(config, "human_operator.pointer");
  return config;
}

}  // namespace

PointerOperator::PointerOperator(const Config& config)
    : config_(checked(config)),
      smoothing_(config.smoothing_rad_s, kDampingRatio, kControlPeriod_s),
      envelope_(force_envelope(config.arm)) {}

void PointerOperator::arm(const Trial& /*trial*/) noexcept {
  smoothing_.reset();
  last_tick_ = -1;
}

OperatorOutput PointerOperator::step(const PointerInput& input) noexcept {
  Flags flags = kGood;
  if (last_tick_ >= 0 && input.tick != last_tick_ + 1) flags |= kInputGap;
  last_tick_ = input.tick;
  if (!std::isfinite(input.pointer_m)) flags |= kInputInvalid;
  if (input.pointer_age_ticks > config_.stale_age_ticks) flags |= kInputStale;

  const bool steered = input.active && input.linked && std::isfinite(input.pointer_m);
  double force_n = 0.0;
  if (steered) {
    const double pointer_m = std::clamp(input.pointer_m, -kFarthest_m, kFarthest_m);
    const auto rest = smoothing_.step(pointer_m / config_.arm.cursor_per_hand);
    force_n = config_.arm.force(rest.x, rest.v, 0.0);
  } else {
    smoothing_.reset();
  }
  const auto out = envelope_.step(force_n, steered);
  return {out.force_n, out.flags | flags};
}

}  // namespace stillhand::human_operator
