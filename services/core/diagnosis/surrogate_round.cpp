// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/surrogate_round.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "services/core/diagnosis/detection/surrogates.hpp"
#include "services/core/diagnosis/fitting/screening.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnosis {
namespace {

// A term by its columns, each with a factor of its own; others by what they add to the prediction.
Eigen::MatrixXd added_by(const Trial& trial, const Screening& screening) {
  const Effect& effect = trial.model.effects.back();
  if (acts_at(effect, Stage::kTerm)) {
    return screening.as_added(screening.term_columns(effect));
  }
  FreeRun run;
  return screening.residual() - residual_of(trial.model, screening.signals(), run);
}

}  // namespace

bool is_tested_by_surrogates(const Trial& trial) {
  const Effect& effect = trial.model.effects.back();
  const EffectKind& kind = effect_kind(effect.kind);
  const Stage stage = kind.stage(effect);
  const bool of_time_alone =
      stage == Stage::kTerm && kind.time_only(effect) && effect.channels.empty();
  return stage != Stage::kWeight && !of_time_alone && !kind.shows_in_rows(effect);
}

std::vector<double> surrogate_p_of(const std::vector<Trial>& tried, const Model& current,
                                   const Signals& judged, const RoundSettings& settings) {
  const Signals part = screened_part(judged);
  const Blocks blocks = part.size() == judged.size() ? settings.blocks : make_blocks(part);
  const Screening screening(current, part, blocks, settings.impulse_response);
  const SurrogateGains gains(screening.jacobian(), screening.residual(), screening.weight(),
                             blocks);
  // Those that were left out before their fit as well: a surrogate may have had a use for them.
  std::vector<SurrogateShares> shares(tried.size());
  settings.for_each(tried.size(), [&](std::size_t i) {
    if (!is_tested_by_surrogates(tried[i])) return;
    const Eigen::MatrixXd added = added_by(tried[i], screening);
    if (added.allFinite()) shares[i] = gains.shares(added);
  });
  Eigen::ArrayXd by_chance = Eigen::ArrayXd::Zero(kSurrogates);
  for (const SurrogateShares& each : shares) {
    if (each.surrogates.size() > 0) by_chance = by_chance.max(each.surrogates);
  }
  std::vector<double> p(tried.size(), 0.0);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (shares[i].surrogates.size() > 0) p[i] = surrogate_p(shares[i].own, by_chance);
  }
  return p;
}

}  // namespace stillhand::diagnosis
