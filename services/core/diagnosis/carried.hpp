// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/model/seen_range.hpp"
#include "services/core/diagnosis/model/stability.hpp"
#include "services/core/diagnosis/record/excited_band.hpp"

namespace stillhand::diagnosis {

/// An effect that was found in a recording and does not help to predict another one.
struct LeftOut {
  Effect effect;    ///< its kind, form and channels
  std::string why;  ///< a clause
  /// Its slow channel is not distinguished from time, Eq. DG-59.
  bool like_time = false;
};

/// The model that predicts other recordings of the same rig, METHOD Eq. DG-58: the effects that
/// another recording can share, fitted again without the others, each with the range in which it
/// was seen.
struct CarriedModel {
  Model model;
  /// For the canceller of the same session: with the effects of time alone that its clock goes on
  /// with (EffectKind::time_only), and with the same shares of the others.
  Model in_session;
  std::vector<LeftOut> left_out;
  std::vector<SeenRange> inputs;   ///< ranges of the inputs
  std::vector<ExcitedBand> bands;  ///< of the inputs, Eq. DG-65; empty: not known
  Stability stability = Stability::kProved;
};

/// @param found     baseline and effects, fitted together
/// @param baseline  without any effect
/// @param counts    [effects] large enough to count, Eq. DG-76; empty: all are
/// Pure.  @throws nothing of its own
CarriedModel carried_model(const Model& found, const Model& baseline, const Signals& signals,
                           const Blocks& blocks, const std::vector<bool>& counts = {});

/// A model as it is, for a file that holds no other: nothing left out, no range known.
CarriedModel carried_as_it_is(Model model);

}  // namespace stillhand::diagnosis
