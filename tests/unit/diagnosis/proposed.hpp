// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

/// What a kind of effect is asked for: a measurement with one of its own planted in it.
namespace stillhand::diagnosis::made {

/// A number of the planted effect.
struct Wanted {
  std::size_t parameter = 0;
  double value = 0.0;
  double proposed_within = 0.0;  ///< of the value as proposed: the grid that was tried
  double fitted_within = 0.0;    ///< after the joint fit
};

struct Planted {
  std::string kind;
  std::string form;  ///< how the proposal's form begins
  std::vector<std::string> channels;
  Measurement measurement;
  double noise = 0.0;  ///< RMS of what was added last
  int order = 2;       ///< of the baseline
  double left = 1.1;   ///< RMSE of the joint fit over the noise, at most
};

/// The kind proposes the right form with numbers near the truth, a joint fit from there finds the
/// numbers and leaves nothing but the noise, and there is a sentence to say it.
inline void expect_proposed(const Planted& planted, const std::vector<Wanted>& wanted = {}) {
  SCOPED_TRACE(planted.kind + ", " + planted.form);
  const Studied of(planted.measurement, planted.order);
  EXPECT_GT(of.baseline.rmse, 1.5 * planted.noise) << "the baseline swallows what is planted";
  const EffectKind& sut = effect_kind(planted.kind);
  const auto proposals = sut.proposed(of.screening);
  const Proposal* found = nullptr;  // the one that explains most
  for (const Proposal& each : proposals) {
    const bool is_wanted =
        each.effect.form.starts_with(planted.form) && each.effect.channels == planted.channels;
    if (is_wanted && (found == nullptr || each.gain > found->gain)) found = &each;
  }
  ASSERT_NE(found, nullptr) << proposals.size() << " proposals, none of that form";
  EXPECT_EQ(found->effect.kind, planted.kind);
  for (const Wanted& each : wanted) {
    EXPECT_NEAR(found->effect.value(each.parameter), each.value, each.proposed_within)
        << found->effect.parameters[each.parameter].name << " as proposed";
  }
  Model model = of.baseline.model;
  if (found->body) model.body = *found->body;
  model.effects.push_back(found->effect);
  const FitOptions options{.max_iterations = 60};
  const FitResult fitted = fit(model, of.signals, of.blocks, options);
  ASSERT_TRUE(fitted.finite);
  EXPECT_LT(fitted.rmse, planted.left * planted.noise);
  for (const Wanted& each : wanted) {
    EXPECT_NEAR(model.effects[0].value(each.parameter), each.value, each.fitted_within)
        << model.effects[0].parameters[each.parameter].name << " as fitted";
  }
  EXPECT_GT(sut.evidence(model.effects[0]).size(), 20u);
}

/// y with noise of 1 % of its RMS, as the last channel behind u and the others.
inline Planted planted_in(const char* kind, const char* form, std::vector<double> y,
                          const std::vector<double>& u, std::vector<std::string> channels = {},
                          std::vector<Channel> others = {}) {
  Planted planted{kind, form, std::move(channels), {}, 0.01 * rms_of(y)};
  const auto noise = white(y.size(), 77);
  for (std::size_t n = 0; n < y.size(); ++n) y[n] += planted.noise * noise[n];
  others.insert(others.begin(), {"u", "V", u});
  others.push_back({"y", "N", std::move(y)});
  planted.measurement = measurement_of(std::move(others));
  return planted;
}

}  // namespace stillhand::diagnosis::made
