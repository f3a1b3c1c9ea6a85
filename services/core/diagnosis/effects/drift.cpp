// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kTriedTimeConstants[] = {0.1, 0.25, 0.5};  // [record lengths]

// Slow noise is no drift: the lowest half-cosines must stand out from those that follow, METHOD
// Eq. DG-32.  For a spectrum like 1/f the ratio is about 5, for 1/f^2 about 25.
constexpr int kSlowest = 3;
constexpr int kFollowing = 15;
constexpr double kLeastRatio = 12.0;

using HalfCosines = std::array<double, kFollowing>;

HalfCosines powers_of(const Eigen::VectorXd& residual, const Signals& signals) {
  HalfCosines power{};
  for (int k = 1; k <= kFollowing; ++k) {
    double sum = 0.0;
    for (std::size_t n = 0; n < signals.size(); ++n) {
      const double t = (signals.time_s()[n] - signals.time_s().front()) / signals.duration_s();
      sum += residual[static_cast<Eigen::Index>(n)] * std::cos(std::numbers::pi * k * t);
    }
    power[static_cast<std::size_t>(k - 1)] = sum * sum;
  }
  return power;
}

// The three lowest in the residual, against those that follow in what the drift leaves: an
// exponential has some of its own there.
bool stands_out(const Effect& drift, const HalfCosines& of_residual, const Screening& screening) {
  Model model = screening.model();
  model.effects.push_back(drift);
  FreeRun run;
  const HalfCosines left =
      powers_of(residual_of(model, screening.signals(), run), screening.signals());
  const double slow =
      std::accumulate(of_residual.begin(), of_residual.begin() + kSlowest, 0.0) / kSlowest;
  const double rest =
      std::accumulate(left.begin() + kSlowest, left.end(), 0.0) / (kFollowing - kSlowest);
  return slow >= kLeastRatio * rest;
}

/// A slow additive change, L the length of the record:
///
///   c (t/L - 1/2);  c e^(-t/tau);  sum_{k=1..3} c_k cos(pi k t/L)
///
/// Source: METHOD Eq. DG-32.
class Drift final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "drift"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kTerm; }
  [[nodiscard]] bool time_only(const Effect& /*effect*/) const override { return true; }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const auto column = [&](auto&& of_share) {
      std::vector<double> x(signals.size());
      for (std::size_t n = 0; n < x.size(); ++n) {
        const double t_s = signals.time_s()[n] - signals.time_s().front();
        x[n] = of_share(t_s);
      }
      columns.push_back(std::move(x));
    };
    const double length_s = signals.duration_s();
    if (effect.form == "linear") {
      column([&](double t_s) { return t_s / length_s - 0.5; });
    } else if (effect.form == "exponential") {
      column([&](double t_s) { return std::exp(-t_s / effect.value(0)); });
    } else {
      for (int k = 1; k <= 3; ++k) {
        column([&](double t_s) { return std::cos(std::numbers::pi * k * t_s / length_s); });
      }
    }
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    Columns columns;
    terms(at.effect(), at.signals, {}, columns);
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    for (std::size_t n = 0; n < at.signals.size(); ++n) {
      double sum = 0.0;
      for (std::size_t c = 0; c < columns.size(); ++c) {
        sum += at.effect().coefficients.at(c) * columns[c][n];
      }
      low = std::min(low, sum);
      high = std::max(high, sum);
    }
    return {{"change", at.model.output_unit, high - low, "from the lowest to the highest"}};
  }
  [[nodiscard]] ControlRole body_role(const Effect& /*effect*/) const override {
    return control::LeftOut{"the force's sensor has a slow offset, or the hand leans"};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override {
    const HalfCosines of_residual = powers_of(screening.residual(), screening.signals());
    std::vector<Effect> forms{{"drift", "linear", {}, {}, {}},
                              {"drift", "slow cosines", {}, {}, {}}};
    const double length_s = screening.signals().duration_s();
    for (const double share : kTriedTimeConstants) {
      forms.push_back({"drift",
                       "exponential",
                       {},
                       {{"time_constant", "s", share * length_s, 0.01 * length_s, 2.0 * length_s}},
                       {}});
    }
    std::vector<Proposal> proposals;
    for (Effect& form : forms) {
      Proposal proposal = screening.with_coefficients(std::move(form));
      if (!stands_out(proposal.effect, of_residual, screening)) continue;
      proposals.push_back(std::move(proposal));
    }
    return best_of(std::move(proposals), 3);
  }
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    if (effect.form == "linear") {
      return "the residual rises by " + with_unit(effect.coefficients.at(0), "(output unit)") +
             " over the record";
    }
    return "the residual changes slowly with time alone, " + effect.form;
  }
};

}  // namespace

const EffectKind& drift_kind() {
  static const Drift kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis
