// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <string_view>
#include <vector>

#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

/// What columns next to a model would explain.
struct ScreenedGain {
  double share = 0.0;  ///< [-] of the squared error, held out, Eq. DG-12; below 0: it would harm
  double p = 1.0;      ///< [-] of such a gain by chance, signed ranks of the blocks
  std::vector<double>
      coefficients;  ///< of the columns, all samples, the model's numbers moving too
};

/// A residual as the kinds of effect see it: a fitted model, its linearisation, and the gain of any
/// columns next to it.  Cheap: products of columns, no simulation.
class Screening {
 public:
  /// @param model  fitted to the signals; must stay until the last use
  /// @param known  proposals of this round with bodies of their own, as they were fitted without
  /// the noise model; a kind takes them up instead of estimating these bodies again, Eq. DG-61
  Screening(const Model& model, const Signals& signals, const Blocks& blocks,
            const ImpulseResponse& impulse_response, std::vector<Proposal> known = {});

  [[nodiscard]] const Model& model() const noexcept { return model_; }
  [[nodiscard]] const Signals& signals() const noexcept { return signals_; }
  [[nodiscard]] const Blocks& blocks() const noexcept { return blocks_; }
  [[nodiscard]] const ImpulseResponse& impulse_response() const noexcept {
    return impulse_response_;
  }
  /// Those of a kind whose bodies have the model's order.
  [[nodiscard]] std::vector<Proposal> known(std::string_view kind) const;
  /// Output - prediction, weighted, initial states taken out.
  [[nodiscard]] const Eigen::VectorXd& residual() const noexcept { return line_.residual; }
  /// Of the residual by the model's numbers, as in Linearisation.
  [[nodiscard]] const Eigen::MatrixXd& jacobian() const noexcept { return line_.jacobian; }
  /// y_b, the body's output.
  [[nodiscard]] const std::vector<double>& body_output() const noexcept { return line_.run.body; }
  [[nodiscard]] const std::vector<double>& prediction() const noexcept {
    return line_.run.prediction;
  }
  [[nodiscard]] const std::vector<double>& weight() const noexcept { return line_.run.weight; }
  /// Root mean square of the residual.
  [[nodiscard]] double rmse() const noexcept { return rmse_; }

  /// Columns as they add to the prediction before the output's map, as the residual is: weighted,
  /// initial states taken out [samples x columns].
  [[nodiscard]] Eigen::MatrixXd as_added(const Columns& columns) const;
  /// @param columns  as they add to the prediction before the output's map
  [[nodiscard]] ScreenedGain gain(const Columns& columns) const;
  /// A column's passages through the body's poles, order + 1 of them (difference basis).
  [[nodiscard]] Columns through_body(const std::vector<double>& column) const;
  /// Columns of an effect, kTerm only, through the body's poles where it passes them.
  [[nodiscard]] Columns term_columns(const Effect& effect) const;
  /// The effect with coefficients as screened, and its gain; kTerm only.
  [[nodiscard]] Proposal with_coefficients(Effect effect) const;

 private:
  const Model& model_;
  const Signals& signals_;
  const Blocks& blocks_;
  const ImpulseResponse& impulse_response_;
  std::vector<Proposal> known_;
  Linearisation line_;
  Grams grams_;
  InitialStates initial_;
  HeldOut held_out_;
  double rmse_ = 0.0;
};

}  // namespace stillhand::diagnosis
