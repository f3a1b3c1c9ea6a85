// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/undeclared/effect_draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/core/contract/units.hpp"
#include "services/core/rig/undeclared/effect_draft.hpp"

namespace stillhand::rig {
namespace {

constexpr std::uint64_t kDrawStream = 0x66610000;
constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr double kNone = 0.1;  // share of the seeds that have no effect

using Spring = ChainEffect::Spring;

class Draw : private EffectDraft {
 public:
  Draw(std::uint64_t seed, const RigConfig& rig) : EffectDraft(seed, kDrawStream, rig) {}

  EffectPlan plan() {
    if (uniform() < kNone) return plan_;
    using Kind = void (Draw::*)();
    constexpr std::array<Kind, 13> kKinds{&Draw::softening_shoulder,
                                          &Draw::hardening_grip,
                                          &Draw::one_way_shoulder,
                                          &Draw::harness,
                                          &Draw::tightening_arm,
                                          &Draw::arm_rest,
                                          &Draw::cogging,
                                          &Draw::friction,
                                          &Draw::fore_aft,
                                          &Draw::roll,
                                          &Draw::tone,
                                          &Draw::delay,
                                          &Draw::cell_limit};
    const double place = uniform() * static_cast<double>(kKinds.size());
    (this->*kKinds[std::min(static_cast<std::size_t>(place), kKinds.size() - 1)])();
    return plan_;
  }

 private:
  void softening_shoulder() {
    name("nonlinear_stiffness", "", "shoulder");
    plan_.chain.spring = Spring::kSofteningShoulder;
    plan_.chain.factor = between(0.5, 0.7);
    note("softer_by", "-", plan_.chain.factor);
    size_chain(&ChainEffect::threshold_m, {0.003, 0.06}, between(0.12, 0.28), "threshold", "m");
  }
  void hardening_grip() {
    name("nonlinear_stiffness", "", "grip");
    plan_.chain.spring = Spring::kHardeningGrip;
    plan_.chain.factor = between(2.0, 4.0);
    note("stiffer_by", "-", plan_.chain.factor);
    size_chain(&ChainEffect::threshold_m, {0.0005, 0.02}, between(0.08, 0.2), "threshold", "m");
  }
  void one_way_shoulder() {
    name("asymmetry", "", "shoulder");
    plan_.chain.spring = Spring::kOneWayShoulder;
    size_chain(&ChainEffect::factor, {0.02, 0.6}, between(0.1, 0.28), "share_of_stiffness", "-");
  }
  void harness() {
    name("dead_zone", "", "harness");
    const bool slack = coin();
    plan_.chain.spring = slack ? Spring::kSlackHarness : Spring::kBumpStop;
    plan_.chain.factor = slack ? between(0.4, 0.7) : between(0.5, 1.5);
    note(slack ? "slack_share_of_seat_stiffness" : "stop_stiffness_over_seat", "-",
         plan_.chain.factor);
    size_chain(&ChainEffect::threshold_m, {0.0005, 0.03}, between(0.12, 0.28), "half_width", "m");
  }
  void tightening_arm() {
    name("time_varying_gain", "", "shoulder and grip");
    plan_.chain.spring = Spring::kTighteningArm;
    plan_.chain.time_s = between(30.0, 90.0);
    note("time_constant", "s", plan_.chain.time_s);
    size_chain(&ChainEffect::factor, {0.1, 2.5}, between(0.15, 0.3), "stiffer_by", "-");
  }
  void arm_rest() {
    name("resonance", "", "arm rest");
    ChainEffect& chain = plan_.chain;
    chain.spring = Spring::kArmRest;
    chain.rest_frequency_hz = between(1.5, 4.0);
    chain.rest_damping = between(0.02, 0.06);
    chain.rest_mass_kg = between(1.0, 3.0);
    note("frequency", "Hz", chain.rest_frequency_hz);
    note("damping_ratio", "-", chain.rest_damping);
    note("mass", "kg", chain.rest_mass_kg);
    // Above 0.7 of the stiffness of the mode, the pad itself would hold the mass.
    const double own_n_m = chain.rest_mass_kg * std::pow(kTwoPi * chain.rest_frequency_hz, 2);
    size_chain(&ChainEffect::pad_stiffness_n_m, {1.0, 0.7 * own_n_m}, between(0.1, 0.28),
               "pad_stiffness", "N/m");
  }
  void cogging() {
    name("position_ripple", "theta", "drive");
    plan_.chain.spring = Spring::kCogging;
    const double teeth = std::floor(between(4.0, 11.0));
    const double period_rad = kTwoPi / (teeth * rig_.motor.capstan_ratio);
    const double share = between(0.08, 0.2);
    plan_.chain.ripple_period_m = period_rad * rig_.stick.lever_m;
    plan_.chain.ripple_phase_rad = between(0.0, kTwoPi);
    plan_.chain.ripple_n = share * std::numbers::sqrt2 * tracking_force_rms(rig_.body, rig_.stick);
    note("amplitude", "N", plan_.chain.ripple_n);
    note("period", "rad", period_rad);
    note("phase", "rad", plan_.chain.ripple_phase_rad);
    note("share_of_tracking_force_rms", "-", share);
  }
  void friction() {
    name("coulomb_friction", "omega", "drive");
    const double share = between(0.1, 0.3);
    plan_.chain.friction_n = share * tracking_force_rms(rig_.body, rig_.stick);
    note("friction", "N", plan_.chain.friction_n);
    note("share_of_tracking_force_rms", "-", share);
  }
  void fore_aft() {
    name("coupled_input", "a_x", "platform and hand");
    plan_.fore_aft_rms_m_s2 = between(0.8, 1.5);
    plan_.fore_aft_lag_s = coin() ? 0.0 : between(0.02, 0.1);
    // Gain of a first-order lag over the band of the shaking, which has a flat density.
    constexpr int kLines = 26;
    double passed = 0.0;
    for (int k = 0; k < kLines; ++k) {
      const double w = kTwoPi * (kForeAftLow_hz + 0.1 * k) * plan_.fore_aft_lag_s;
      passed += 1.0 / (1.0 + w * w) / kLines;
    }
    const double share = between(0.1, 0.28);
    plan_.fore_aft_mass_kg = (coin() ? 1.0 : -1.0) * share * pegged().plain_rms_n() /
                             (plan_.fore_aft_rms_m_s2 * std::sqrt(passed));
    note("acceleration_rms", "m/s^2", plan_.fore_aft_rms_m_s2);
    note("force_per_acceleration", "N/(m/s^2)", plan_.fore_aft_mass_kg);
    note("lag", "s", plan_.fore_aft_lag_s);
    note("share_of_force_rms", "-", share);
  }
  void roll() {
    name("coupled_input", "roll", "platform and arm");
    plan_.roll_rms_rad = between(2.5, 4.5) * kRadPerDegree;
    const double pull_m_s2 = kGravity_m_s2 * plan_.roll_rms_rad;
    const double wanted = between(0.1, 0.28);
    plan_.borne_mass_kg =
        std::clamp(wanted * pegged().plain_rms_n() / pull_m_s2, 0.5, kWholeArm_kg);
    note("roll_rms", "rad", plan_.roll_rms_rad);
    note("borne_mass", "kg", plan_.borne_mass_kg);
    note("share_of_force_rms", "-", plan_.borne_mass_kg * pull_m_s2 / pegged().plain_rms_n());
  }
  void tone() {
    name("tone", "", "hand");
    const double share = between(0.08, 0.2);
    plan_.tone_n = share * std::numbers::sqrt2 * pegged().plain_rms_n();
    plan_.tone_hz = between(6.0, 16.0);
    plan_.tone_phase_rad = between(0.0, kTwoPi);
    note("amplitude", "N", plan_.tone_n);
    note("frequency", "Hz", plan_.tone_hz);
    note("phase_at_start", "rad", plan_.tone_phase_rad);
    note("share_of_force_rms", "-", share);
  }
  void delay() {
    const bool motor = coin();
    name("delay", "", motor ? "motor path" : "load cell");
    const auto ticks = static_cast<std::size_t>(std::floor(between(10.0, 61.0)));
    (motor ? plan_.motor_delay_ticks : plan_.cell_delay_ticks) = ticks;
    note("delay", "s", static_cast<double>(ticks) * kControlPeriod_s);
    std::vector<double> late(pegged().plain_n());
    std::rotate(late.begin(), late.end() - static_cast<std::ptrdiff_t>(ticks), late.end());
    note("share_of_force_rms", "-", pegged().share(late));
  }
  void cell_limit() {
    name("output_saturation", "", "load cell");
    const auto share = [&](double limit_n) {
      std::vector<double> clipped = pegged().plain_n();
      for (double& each : clipped) each = std::clamp(each, -limit_n, limit_n);
      return pegged().share(clipped);
    };
    plan_.cell_limit_n = sized(0.3 * pegged().plain_rms_n(), 4.0 * pegged().plain_rms_n(),
                               between(0.12, 0.24), share);
    note("limit", "N", plan_.cell_limit_n);
    note("share_of_force_rms", "-", share(plan_.cell_limit_n));
  }

  /// 0.05 of a body mass of 75 kg: Winter (2009), table 4.1, total arm.
  static constexpr double kWholeArm_kg = 3.75;
};

}  // namespace

EffectPlan draw_effect(std::uint64_t seed, const RigConfig& sized_for) {
  return Draw(seed, sized_for).plan();
}

}  // namespace stillhand::rig
