// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/recorded/decision.hpp"

#include <algorithm>

namespace stillhand::close_the_loop {
namespace {

// What C and C+ leave of every record on which both can be compared, as one.
class Pairs {
 public:
  void add(const Level& linear, const Level& augmented, double seconds) {
    linear_.push_back(linear);
    augmented_.push_back(augmented);
    seconds_.push_back(seconds);
  }
  [[nodiscard]] std::optional<Remaining> pooled_step() const {
    if (linear_.empty()) return std::nullopt;
    return Remaining{pooled(linear_, seconds_), pooled(augmented_, seconds_), {}};
  }

 private:
  std::vector<Level> linear_;
  std::vector<Level> augmented_;
  std::vector<double> seconds_;
};

bool leaves_more(const Judged& judged, bool by_motor) {
  if (by_motor && !(judged.motor_linear && judged.motor_augmented)) return false;
  const Remaining step{by_motor ? judged.motor_linear->left : judged.linear.left,
                       by_motor ? judged.motor_augmented->left : judged.augmented.left,
                       {}};
  const auto saved95 = step.cut_interval95();
  return saved95 && saved95->second < 0.0;
}

}  // namespace

Decision decide(const std::vector<Judged>& judged, bool same, bool motor_may, bool plus_runs) {
  Decision out;
  out.same = same;
  Pairs by_motor;
  Pairs by_prediction;
  for (const Judged& each : judged) {
    by_prediction.add(each.linear.left, each.augmented.left, each.seconds);
    if (!each.motor_augmented) continue;
    // A linear model that the canceller does not take leaves the force as it is.
    by_motor.add(each.motor_linear ? each.motor_linear->left : each.motor_augmented->without,
                 each.motor_augmented->left, each.seconds);
  }
  out.step = by_motor.pooled_step();
  out.by_motor = motor_may && (out.step || !plus_runs);
  if (!out.by_motor) out.step = by_prediction.pooled_step();
  for (const Judged& each : judged) {
    if (leaves_more(each, out.by_motor)) out.worse.push_back(each.source);
  }
  Pairs kept;
  for (const Judged& each : judged) {
    const auto& motor =
        out.kept() && each.motor_augmented ? each.motor_augmented : each.motor_linear;
    const Remaining& prediction = out.kept() ? each.augmented : each.linear;
    const Remaining& of = out.by_motor && motor ? *motor : prediction;
    kept.add(of.without, of.left, each.seconds);
  }
  const auto whole = kept.pooled_step();
  out.helps = !whole || whole->left.rms < whole->without.rms;
  return out;
}

}  // namespace stillhand::close_the_loop
