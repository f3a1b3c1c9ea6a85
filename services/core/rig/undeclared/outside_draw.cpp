// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/undeclared/outside_draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/core/rig/undeclared/effect_draft.hpp"

namespace stillhand::rig {
namespace {

constexpr std::uint64_t kOutsideStream = 0x66610010;

using Spring = ChainEffect::Spring;

class OutsideDraw : private EffectDraft {
 public:
  OutsideDraw(std::uint64_t seed, const RigConfig& rig) : EffectDraft(seed, kOutsideStream, rig) {}

  EffectPlan plan() {
    using Kind = void (OutsideDraw::*)();
    constexpr std::array<Kind, 5> kKinds{
        &OutsideDraw::reflex, &OutsideDraw::arm_drag, &OutsideDraw::stick_drag,
        &OutsideDraw::fractional_shoulder, &OutsideDraw::vibration_grip};
    const double place = uniform() * static_cast<double>(kKinds.size());
    (this->*kKinds[std::min(static_cast<std::size_t>(place), kKinds.size() - 1)])();
    return plan_;
  }

 private:
  // Of the pegged force. A hand's own force is 0.13 to 0.3 of it (0.9 to 2.2 N of 7 N); a verdict
  // can name what has 0.75 of the RMS of that.
  double wanted_share() { return coin() ? between(0.05, 0.25) : between(0.4, 0.8); }
  void size(double ChainEffect::* number, Range range, const char* what, const char* unit) {
    const double share = size_chain(number, range, wanted_share(), what, unit);
    note("force_rms", "N", share * pegged().plain_rms_n());
    note("force_beyond_linear", "N", pegged().beyond_linear_n(pegged().force_n(plan_.chain)));
  }

  void reflex() {
    name("delayed_reflex", "", "shoulder");
    plan_.chain.spring = Spring::kDelayedReflex;
    plan_.chain.time_s = between(0.03, 0.08);
    note("delay", "s", plan_.chain.time_s);
    // With 500 N/m the slowest of these hands rings for 20 s, with 870 N/m it never stops.
    size(&ChainEffect::outside, {0.01, 300.0}, "stiffness", "N/m");
  }
  void arm_drag() {
    name("square_drag", "", "arm");
    plan_.chain.spring = Spring::kArmDrag;
    size(&ChainEffect::outside, {0.01, 10000.0}, "drag", "N s^2/m^2");
  }
  void stick_drag() {
    name("square_drag", "omega", "drive");
    plan_.chain.spring = Spring::kStickDrag;
    // Of a velocity of 0.1 m/s RMS, about that of a hand under condition B, v|v| has an RMS of
    // sqrt(3) v^2.  The threshold of the drive is 0.2 N.
    constexpr double kSpeed_m_s = 0.1;
    const double force_n = coin() ? between(0.1, 0.4) : between(1.0, 2.0);
    plan_.chain.outside = force_n / (std::numbers::sqrt3 * kSpeed_m_s * kSpeed_m_s);
    note("drag", "N s^2/m^2", plan_.chain.outside);
    note("force_rms", "N", force_n);
  }
  void fractional_shoulder() {
    name("fractional_damping", "", "shoulder");
    plan_.chain.spring = Spring::kFractionalShoulder;
    plan_.chain.exponent = between(0.3, 0.7);
    note("exponent", "-", plan_.chain.exponent);
    size(&ChainEffect::outside, {0.001, 500.0}, "coefficient", "N s^a/m");
  }
  void vibration_grip() {
    name("vibration_grip", "", "grip");
    plan_.chain.spring = Spring::kVibrationGrip;
    plan_.chain.time_s = between(0.5, 3.0);
    plan_.chain.threshold_m = between(0.001, 0.004);
    note("time_constant", "s", plan_.chain.time_s);
    note("vibration_of_half_the_increase", "m", plan_.chain.threshold_m);
    size(&ChainEffect::factor, {0.001, 4.0}, "stiffer_by", "-");
  }
};

}  // namespace

EffectPlan draw_outside(std::uint64_t seed, const RigConfig& sized_for) {
  return OutsideDraw(seed, sized_for).plan();
}

}  // namespace stillhand::rig
