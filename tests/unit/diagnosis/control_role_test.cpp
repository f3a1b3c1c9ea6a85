// SPDX-License-Identifier: Apache-2.0
// What a canceller does about each kind, and what the kinds' terms are measured in.
#include "services/core/diagnosis/model/control_role.hpp"

#include <gtest/gtest.h>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::control_role_test {

using namespace control;

template <class Law>
std::size_t index_of(Law law) {
  return ControlRole(std::move(law)).index();
}

struct Role {
  Effect effect;
  std::size_t body;
  std::size_t drive;
};

const std::size_t kNone = index_of(control::LeftOut{});

// One effect of each kind, and of every form that acts at another stage.
std::vector<Role> every_role() {
  const auto spring = index_of(Spring{});
  const auto before = index_of(InputMap{});
  const auto behind = index_of(OutputMap{});
  const auto gain = index_of(Gain{});
  return {
      {{"delay", "of the input", {}, {{"delay", "s", 0.04}}, {}}, index_of(InputDelay{}), kNone},
      {{"clock_drift", "", {}, {{"drift", "us/s", 9.0}, {"t", "s", 1.0}}, {}}, kNone, kNone},
      {{"resonance", "", {}, {{"f", "Hz", 7.0}, {"z", "-", 0.1}}, {1.0, 2.0}},
       index_of(Mode{}),
       kNone},
      {{"coupled_input", "static", {"a_x"}, {}, {1.0}}, index_of(Path{}), kNone},
      {{"coulomb_friction", "sign, beside the body", {"omega"}, {}, {1.0}},
       kNone,
       index_of(Friction{})},
      {{"nonlinear_stiffness", "bent of the output", {}, {{"threshold", "N", 1.0}}, {}},
       spring,
       kNone},
      {{"nonlinear_stiffness", "at the output", {}, {{"cubic", "1/N^2", 0.1}}, {}}, behind, kNone},
      {{"asymmetry", "slopes at the input", {"a_y"}, {{"slope_change", "-", 0.1}}, {}},
       before,
       kNone},
      {{"asymmetry", "square inside the body", {}, {}, {}}, spring, kNone},
      {{"hysteresis", "smooth, beside the body", {"theta"}, {{"threshold", "rad", 1.0}}, {1.0}},
       index_of(Hysteresis{}),
       kNone},
      {{"hysteresis", "smooth inside the body", {}, {}, {}}, spring, kNone},
      {{"dead_zone", "at the input", {"a_y"}, {{"half_width", "m/s^2", 0.1}}, {}}, before, kNone},
      {{"output_saturation", "hard", {}, {{"limit", "N", 5.0}}, {}}, index_of(NotFelt{}), kNone},
      {{"output_saturation", "stop above", {}, {{"limit", "N", 5.0}}, {}}, kNone, kNone},
      {{"input_saturation", "soft", {"a_y"}, {{"limit", "m/s^2", 1.0}}, {}}, before, kNone},
      {{"position_ripple", "one harmonic", {"theta"}, {{"f", "1/rad", 4.0}}, {1.0, 2.0}},
       kNone,
       index_of(Waves{})},
      {{"tone", "beside the body", {}, {{"f", "Hz", 9.3}}, {1.0, 2.0}}, index_of(Waves{}), kNone},
      {{"drift", "linear", {}, {}, {1.0}}, kNone, kNone},
      {{"time_varying_gain", "linear", {}, {{"change", "-", 0.1}}, {}}, gain, kNone},
      {{"regime_change", "step of the gain", {}, {{"time", "s", 1.0}, {"c", "-", 0.1}}, {}},
       gain,
       kNone},
      {{"bilinear", "gain of the body", {"temp"}, {{"s", "-", 0.1}, {"c", "degC", 1.0}}, {}},
       kNone,
       kNone},
      {{"bilinear", "beside the body", {"a_x", "theta"}, {{"c", "", 0.0}, {"d", "", 0.0}}, {1.0}},
       kNone,
       kNone},
      {{"transients", "isolated bursts", {}, {}, {}}, kNone, kNone},
      {{"free_form", "gain over a channel", {"temp"}, {}, {}}, kNone, kNone}};
}

TEST(ControlRoleTest, AKindStatesWhatTheCancellerDoesAboutIt) {
  for (const Role& each : every_role()) {
    SCOPED_TRACE(each.effect.kind + ", " + each.effect.form);
    const EffectKind& kind = effect_kind(each.effect.kind);
    const ControlRole body = kind.body_role(each.effect);
    const ControlRole drive = kind.drive_role(each.effect);
    EXPECT_EQ(body.index(), each.body);
    EXPECT_EQ(drive.index(), each.drive);
    for (const ControlRole& role : {body, drive}) {
      if (const auto* left_out = std::get_if<control::LeftOut>(&role)) {
        EXPECT_FALSE(left_out->reason.empty());
      }
    }
  }
}

TEST(ControlRoleTest, ARoleCarriesItsNumbers) {
  const Effect mode{"resonance", "", {}, {{"f", "Hz", 7.0}, {"z", "-", 0.1}}, {1.0, 2.0}};
  const auto of_mode = std::get<Mode>(effect_kind("resonance").body_role(mode));
  EXPECT_EQ(of_mode.frequency_hz, 7.0);
  EXPECT_EQ(of_mode.damping_ratio, 0.1);
  const auto path = [](const Effect& effect) {
    return std::get<Path>(effect_kind("coupled_input").body_role(effect));
  };
  EXPECT_EQ(path({"coupled_input", "lagged", {"a_x"}, {{"lag", "s", 0.3}}, {1.0}}).lag_s, 0.3);
  EXPECT_EQ(path({"coupled_input", "static", {"a_x"}, {}, {1.0}}).lag_s, 0.0);
  EXPECT_TRUE(path({"coupled_input", "through the body", {"a_x"}, {}, {1.0}}).through_body);
  const Effect stop = made::effect_of("hysteresis", "elastic-plastic, beside the body", {"theta"},
                                      {{"threshold", "rad", 0.4}}, {0.3, -0.1});
  const auto memory = std::get<Hysteresis>(effect_kind("hysteresis").body_role(stop));
  EXPECT_EQ(memory.operation, signal::HysteresisOperator::kStop);
  EXPECT_EQ(memory.threshold, 0.4);
  const Effect dahl{"hysteresis", "smooth inside the body", {}, {}, {}};
  EXPECT_EQ(std::get<Spring>(effect_kind("hysteresis").body_role(dahl)).memory,
            signal::HysteresisOperator::kDahl);
  const Effect smooth{
      "coulomb_friction", "smooth sign, beside the body", {"omega"}, {{"v", "rad/s", 0.2}}, {1.0}};
  const auto friction = std::get<Friction>(effect_kind("coulomb_friction").drive_role(smooth));
  EXPECT_EQ(friction.transition, 0.2);
}

TEST(ControlRoleTest, TermsNameTheirUnits) {
  const std::vector<double> x = made::ride(600, 1);
  const Signals signals(
      made::measurement_of(
          {{"u", "m/s^2", x}, {"theta", "rad", x}, {"temp", "degC", x}, {"y", "N", x}}),
      {"u"}, "y");
  const auto unit = [&](const Effect& effect, std::size_t i) {
    return effect_kind(effect.kind).column_unit(effect, signals, i);
  };
  EXPECT_EQ(unit({"coulomb_friction", "", {"theta"}, {}, {}}, 0), "-");
  EXPECT_EQ(unit({"coupled_input", "static with rate", {"theta", "u"}, {}, {}}, 0), "rad");
  EXPECT_EQ(unit({"coupled_input", "static with rate", {"theta", "u"}, {}, {}}, 1), "m/s^2");
  EXPECT_EQ(unit({"nonlinear_stiffness", "", {"theta"}, {}, {}}, 1), "rad^3");
  EXPECT_EQ(unit({"asymmetry", "square, beside the body", {"u"}, {}, {}}, 0), "(m/s^2)^2");
  EXPECT_EQ(unit({"bilinear", "", {"theta", "temp"}, {}, {}}, 0), "rad*degC");
  EXPECT_EQ(unit({"hysteresis", "", {"theta"}, {}, {}}, 0), "-");
  EXPECT_EQ(unit({"hysteresis", "", {"theta"}, {}, {}}, 1), "rad");
  EXPECT_EQ(unit({"resonance", "", {}, {}, {}}, 0), "");
}

TEST(ControlRoleTest, APowerOfAUnitIsWrittenAsInAHeader) {
  EXPECT_EQ(unit_power("m", 3), "m^3");
  EXPECT_EQ(unit_power("m/s", 2), "(m/s)^2");
  EXPECT_EQ(unit_power("-", 2), "-");
  EXPECT_EQ(unit_power("", 2), "-");
}

}  // namespace stillhand::diagnosis::control_role_test
