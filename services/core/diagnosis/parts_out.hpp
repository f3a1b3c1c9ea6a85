// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/fitting/response_prior.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"
#include "services/core/diagnosis/share.hpp"
#include "services/core/diagnosis/start_state.hpp"

namespace stillhand::diagnosis {

/// What a model leaves of parts that it was not fitted to, joined.
struct OutOfParts {
  bool finite = false;
  Eigen::VectorXd residual;  ///< [samples] weighted [unit of the output], from an assumed past
  Eigen::VectorXd started;   ///< the same from a start state, Eq. DG-82
};

/// A map, or a factor on the body's output.
bool scales_body(const Effect& effect);
/// True where the body is what the baseline is, or, next to a map or a gain, a multiple of it: a
/// delay or a mode takes a part of its response over, and a path through it excites it where the
/// inputs do not.
bool has_body_of_baseline(const Model& model, const Signals& signals);

/// Samples that a start state comes from, for each of its numbers.
inline constexpr std::size_t kGivenForANumber = 5;

/// Judges models on parts that are held out whole, METHOD Eq. DG-58, DG-68 and DG-69: thirds of a
/// recording, or the recordings that were joined.  Pure; it refers to what it is made from.
class PartsOut {
 public:
  /// @param signals  bursts weigh nothing
  /// @param noise    [samples] what the model of the verdict leaves, weighted
  /// @param rms      [unit of the output] of the noise
  /// @param given    samples of a part from which its start state comes
  PartsOut(const Model& found, const Signals& signals, const Blocks& blocks,
           const Eigen::VectorXd& noise, double rms, std::size_t given);

  /// Each part by a fit to the others, from the past that `predict` assumes and from a start state.
  [[nodiscard]] OutOfParts left_by(const Model& model) const;
  /// [unit of the output] of left_by(), as bodies of such signals are judged; infinite where a run
  /// is not finite.
  [[nodiscard]] double rmse(const Model& model) const;
  /// By blocks, from a start state.
  [[nodiscard]] HeldOut from_start(const Model& model) const;
  /// Of what one model predicts beyond the other: as it is or behind the noise model, by the one
  /// with the smaller standard error.
  [[nodiscard]] Share share(const OutOfParts& without, const OutOfParts& with) const;

  /// [-] of the power of what one model predicts beyond the other that a mean over one period of
  /// the lowest excited frequency keeps, METHOD Eq. DG-77.
  [[nodiscard]] double slow_share(const OutOfParts& without, const OutOfParts& with) const;

  /// Of the body of a model whose effects scale it, or do not, from now on.  The prior stays with
  /// the caller.
  void assume(const ResponsePrior& prior, bool of_scaled_body);
  /// Fitted to all parts from its own numbers, from another body's and from a body that is
  /// estimated again; the best end.
  [[nodiscard]] Model refitted(Model model, const Body& other) const;

 private:
  [[nodiscard]] bool several() const { return signals_.stretches().back().recording > 0; }
  [[nodiscard]] bool helps_one(const OutOfParts& without, const OutOfParts& with) const;
  [[nodiscard]] Signals without_part(std::size_t part) const;
  [[nodiscard]] FreeRun run_from_start(const Model& model, double noise) const;
  struct Fitted {
    Model model;
    double rmse;  // of the parts that it was fitted to
  };
  [[nodiscard]] Fitted fitted_without(std::size_t part, const Model& model) const;
  [[nodiscard]] const Eigen::VectorXd& judged(const OutOfParts& out) const;
  [[nodiscard]] const ResponsePrior* prior_of(const Model& model) const;

  const Signals& signals_;
  const Blocks& blocks_;
  const ResponsePrior* prior_ = nullptr;
  bool of_scaled_body_ = false;
  const ResponsePrior paths_;
  const Blocks parts_;
  const Signals apart_;  ///< every part starts as a recording does
  const Signals with_pasts_;
  const Signals heads_;         ///< of every part, as much as a start state depends on
  const GivenRows given_;       ///< rows of the heads, from which it comes
  std::vector<Signals> rests_;  ///< [parts] of a long record, pieces of the others; else empty
};

}  // namespace stillhand::diagnosis
