// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/planted_limits.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "services/core/diagnosis/detection/moved_residuals.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/examples.hpp"
#include "services/core/diagnosis/selection.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::diagnosis {
namespace {

// The rule of the search, Eq. DG-17, asked of a column that was planted in moved residuals.
class PlantedRule {
 public:
  // @param plain, behind  without the noise model and with it; null: there is none
  PlantedRule(const MovedResiduals& plain, const MovedResiduals* behind, const LastRound& round,
              const SearchOptions& options)
      : plain_(plain), behind_(behind), round_(round), options_(options) {}

  // [-] of the moved residuals, in which it is found.
  // @param factor  of column k; the residual has the column with it
  // @param left_out  the effect leaves samples out instead of explaining them
  [[nodiscard]] double share_found(Eigen::Index k, double factor, bool left_out) const;

 private:
  [[nodiscard]] bool is_found(Eigen::Index k, double factor, std::size_t i) const;
  [[nodiscard]] bool is_burst(Eigen::Index k, double factor, std::size_t i) const;

  const MovedResiduals& plain_;
  const MovedResiduals* behind_;
  const LastRound& round_;
  const SearchOptions& options_;
};

Comparison asked_of(const MovedResiduals& residuals, Eigen::Index k, double factor, std::size_t i) {
  return compared(residuals.without(k, factor, i), residuals.with(k, factor, i));
}

double PlantedRule::share_found(Eigen::Index k, double factor, bool left_out) const {
  double found = 0.0;
  for (std::size_t i = 0; i < plain_.count(); ++i) {
    if (left_out ? is_burst(k, factor, i) : is_found(k, factor, i)) found += 1.0;
  }
  return found / static_cast<double>(plain_.count());
}

// Behind the filter, and then without it the error has to fall as well; or without it alone.
bool PlantedRule::is_found(Eigen::Index k, double factor, std::size_t i) const {
  const auto passes = [this](const Comparison& comparison) {
    return worth_it(comparison, options_, round_.least_fall, round_.candidates);
  };
  const Comparison plain = asked_of(plain_, k, factor, i);
  if (passes(plain)) return true;
  return behind_ != nullptr && 1.0 - plain.rmse_ratio > round_.least_fall &&
         passes(asked_of(*behind_, k, factor, i));
}

bool PlantedRule::is_burst(Eigen::Index k, double factor, std::size_t i) const {
  const HeldOut with_burst = plain_.without(k, factor, i);
  return 1.0 - compared(with_burst, plain_.without(k, 0.0, i)).rmse_ratio > options_.large_fall;
}

constexpr std::size_t kMoved = 12;
constexpr double kSmallestPlanted = 0.02;  // [-] of the residual
constexpr double kLargestPlanted = 20.0;
constexpr int kHalvings = 8;  // of the range on a logarithmic axis: to 3 %

// What an effect adds to the prediction, about its mean, with an RMS of 1; of one that leaves
// samples out, a step at these.  Zeros where it adds nothing.
Eigen::VectorXd added_by(const Effect& effect, const Model& model, const Signals& signals,
                         const FreeRun& without) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(std::ssize(without.prediction));
  Model with = model;
  with.effects.push_back(effect);
  const FreeRun run = free_run(with, signals);
  if (!run.finite) return column;
  const Eigen::Map<const Eigen::VectorXd> weight(without.weight.data(), std::ssize(without.weight));
  const Eigen::Map<const Eigen::VectorXd> weight_with(run.weight.data(), std::ssize(run.weight));
  if (acts_at(effect, Stage::kWeight)) {
    column = weight - weight_with;
  } else {
    column = Eigen::Map<const Eigen::VectorXd>(run.prediction.data(), column.size()) -
             Eigen::Map<const Eigen::VectorXd>(without.prediction.data(), column.size());
    column.array() -= column.dot(weight) / weight.sum();
  }
  const double rms = column.cwiseProduct(weight).norm() / std::sqrt(weight.sum());
  return rms > 0.0 ? Eigen::VectorXd(column / rms) : Eigen::VectorXd::Zero(column.size());
}

// The last channel that it reads and that is no input.
std::string channel_of(const Effect& effect, const Signals& signals) {
  std::string channel;
  for (const std::string& each : effect.channels) {
    if (!signals.is_input(each)) channel = each;
  }
  return channel;
}

PlantedLimit limit_of(const Effect& effect, Eigen::Index k, double residual_rms,
                      const PlantedRule& rule) {
  const bool left_out = acts_at(effect, Stage::kWeight);
  const auto share_found = [&](double size) {
    return rule.share_found(k, size * residual_rms, left_out);
  };
  PlantedLimit limit;
  limit.kind = effect.kind;
  std::ranges::transform(kPlantedSizes, limit.found.begin(), share_found);
  double low = kSmallestPlanted;
  double high = kLargestPlanted;
  if (share_found(high) < 0.5) {
    limit.half = std::numeric_limits<double>::infinity();
    return limit;
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    (share_found(middle) < 0.5 ? low : high) = middle;
  }
  limit.half = high * residual_rms;
  return limit;
}

std::vector<PlantedLimit> hardest_of_each(const std::vector<PlantedLimit>& all) {
  std::vector<PlantedLimit> hardest;
  for (const EffectKind* kind : effect_kinds()) {
    const PlantedLimit* worst = nullptr;
    for (const PlantedLimit& each : all) {
      if (each.kind == kind->name() && (worst == nullptr || each.half > worst->half)) worst = &each;
    }
    if (worst != nullptr) hardest.push_back(*worst);
  }
  return hardest;
}

}  // namespace

std::vector<PlantedLimit> planted_limits(const Model& model, const Signals& signals,
                                         const Signals& whitened, const Blocks& blocks,
                                         const LastRound& round, const SearchOptions& options,
                                         const ForEach& for_each) {
  FreeRun run;
  const Eigen::VectorXd residual = residual_of(model, signals, run);
  const double rms = residual.norm() / std::sqrt(std::max(sum_of(run.weight), 1.0));
  if (!run.finite || is_rounding(rms, signals)) return {};
  const std::vector<Effect> effects = examples(model, signals);
  Eigen::MatrixXd added(residual.size(), std::ssize(effects));
  for_each(effects.size(), [&](std::size_t k) {
    added.col(static_cast<Eigen::Index>(k)) = added_by(effects[k], model, signals, run);
  });
  const MovedResiduals plain(model, signals, blocks, added, kMoved);
  std::optional<MovedResiduals> behind;
  if (whitened.is_whitened()) behind.emplace(model, whitened, blocks, added, kMoved);
  const PlantedRule rule(plain, behind ? &*behind : nullptr, round, options);
  std::vector<PlantedLimit> all(effects.size());
  for_each(effects.size(), [&](std::size_t e) {
    const auto k = static_cast<Eigen::Index>(e);
    if (!(added.col(k).squaredNorm() > 0.0)) return;
    all[e] = limit_of(effects[e], k, rms, rule);
    all[e].channel = channel_of(effects[e], signals);
    all[e].beyond_linear = acts_at(effects[e], Stage::kWeight) ? 1.0 : plain.beyond(k);
  });
  return hardest_of_each(all);
}

double typical_limit(const std::vector<PlantedLimit>& limits) {
  std::vector<double> sizes;
  for (const PlantedLimit& each : limits) {
    if (std::isfinite(each.half)) sizes.push_back(each.half * each.beyond_linear);
  }
  return signal::middle_of(sizes);
}

}  // namespace stillhand::diagnosis
