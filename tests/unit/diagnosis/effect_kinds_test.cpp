// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::effect_kinds_test {

using testing::IsSupersetOf;

constexpr std::size_t kCount = 6001;

// What a script may expect in the field `kind` of the verdict.
TEST(EffectKindsTest, EveryKindOfTheContractIsThere) {
  std::vector<std::string> names;
  for (const EffectKind* kind : effect_kinds()) names.emplace_back(kind->name());
  EXPECT_THAT(names, IsSupersetOf({"delay", "resonance", "coupled_input", "coulomb_friction",
                                   "nonlinear_stiffness", "asymmetry", "hysteresis", "dead_zone",
                                   "output_saturation", "input_saturation", "position_ripple",
                                   "tone", "drift", "time_varying_gain", "regime_change",
                                   "clock_drift", "bilinear", "transients", "free_form"}));
  for (const std::string& name : names) EXPECT_EQ(effect_kind(name).name(), name);
}

TEST(EffectKindsTest, AKindThatIsNotThereIsRefused) {
  EXPECT_THROW(effect_kind("gremlins"), ConfigError);
  EXPECT_THROW(effect_kind(""), ConfigError);
}

// A recording with several channels of every quantity, no effect in it: whatever a kind proposes
// must be ready to be fitted; three want to see something first.
TEST(EffectKindsTest, EveryProposalCanBeRunAndFitted) {
  const auto u = made::ride(kCount, 1);
  const Body body = made::four_pole_body();
  auto y = made::answer(body, u);
  const auto noise = made::white(kCount, 2);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += 0.05 * noise[n];
  const made::Studied of(made::measurement_of({{"u", "m/s^2", u},
                                               {"theta", "rad", made::ride(kCount, 3, 0.1, 1.0)},
                                               {"a_x", "m/s^2", made::ride(kCount, 4)},
                                               {"temp", "degC", made::ride(kCount, 5, 0.1, 1.0)},
                                               {"y", "N", y}}),
                         4);
  std::vector<std::size_t> counts;
  for (const EffectKind* kind : effect_kinds()) {
    const auto proposals = kind->proposed(of.screening);
    counts.push_back(proposals.size());
    for (const Proposal& proposal : proposals) {
      SCOPED_TRACE(proposal.effect.kind + ", " + proposal.effect.form);
      EXPECT_EQ(proposal.effect.kind, kind->name());
      for (const Parameter& parameter : proposal.effect.parameters) {
        EXPECT_TRUE(std::isfinite(parameter.value)) << parameter.name;
        EXPECT_LE(parameter.lower, parameter.upper) << parameter.name;
        EXPECT_FALSE(parameter.name.empty());
      }
      Model model = of.baseline.model;
      if (proposal.body) model.body = *proposal.body;
      model.effects.push_back(proposal.effect);
      EXPECT_GT(complexity(proposal.effect), 0u);
      const FitOptions options{.max_iterations = 2};
      EXPECT_GT(fit(model, of.signals, of.blocks, options).rmse, 0.0);
      EXPECT_FALSE(kind->evidence(model.effects[0]).empty());
      FreeRun run = free_run(model, of.signals, !kind->time_only(proposal.effect));
      EXPECT_EQ(run.prediction.size(), kCount);
    }
  }
  // In the order of kinds.hpp: of each form or kind of place the best one or few.
  EXPECT_THAT(counts,
              testing::ElementsAre(2, 2, 4, 3, 4, 8, 6, 7, 3, 4, 3, 0, 0, 3, 1, 1, 3, 0, 5));
}

// What a recording can't hold isn't proposed: one input, no other channel, no body.
TEST(EffectKindsTest, WithoutChannelsOrABodyTheirKindsAreSilent) {
  const auto u = made::ride(kCount, 1);
  std::vector<double> y = made::white(kCount, 2);
  for (std::size_t n = 0; n < kCount; ++n) y[n] = 2.0 * u[n] + 0.1 * y[n];
  const made::Studied of(made::measurement_of({{"u", "V", u}, {"y", "N", y}}), 0);
  for (const char* kind : {"coupled_input", "coulomb_friction", "position_ripple", "bilinear",
                           "resonance", "hysteresis"}) {
    EXPECT_TRUE(effect_kind(kind).proposed(of.screening).empty()) << kind;
  }
}

TEST(EffectKindsTest, SomeKindsComeOnceAlone) {
  const auto u = made::ride(kCount, 1);
  const Body body = made::two_pole_body();
  const auto y = made::answer(body, u);
  const Signals signals = made::signals_of(u, y);
  const Blocks blocks = make_blocks(signals);
  const ImpulseResponse impulse_response = fit_impulse_response(signals);
  const Effect once[] = {
      {"delay", "of the input", {}, {{"delay", "s", 0.02, -0.1, 0.5}}, {}},
      made::effect_of("clock_drift", "of the output", {},
                      {{"drift", "us/s", 10.0, -2e4, 2e4}, constant("reference_time", "s", 30.0)}),
      {"input_saturation", "hard", {"u"}, {{"limit", "V", 2.0, 0.1, 9.0}}, {}},
      {"output_saturation", "hard", {}, {{"limit", "N", 9.0, 0.1, 9.0}}, {}},
      made::effect_of(
          "transients", "isolated bursts", {},
          {{"begin_1", "s", 3.0, 0.0, 60.0, false}, {"end_1", "s", 3.5, 0.0, 60.0, false}}),
      made::effect_of("nonlinear_stiffness", "cubic of the output", {},
                      {{"threshold", "N", 5.0, 0.1, 9.0}}, {-1e-6, 0.0})};
  for (const Effect& effect : once) {
    const Model model = made::model_of(body, {effect});
    const Screening screening(model, signals, blocks, impulse_response);
    const auto again = effect_kind(effect.kind).proposed(screening);
    EXPECT_TRUE(std::ranges::none_of(again, [&](const Proposal& proposal) {
      return proposal.effect.form == effect.form;
    })) << effect.kind;
  }
}

}  // namespace stillhand::diagnosis::effect_kinds_test
