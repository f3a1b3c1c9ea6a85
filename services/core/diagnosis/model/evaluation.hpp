// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// A model's free run over a measurement.
struct FreeRun {
  bool finite = true;                ///< false: unstable, or it ran away
  std::vector<double> body;          ///< y_b of Eq. DG-1 with feedback, before gain, terms and maps
  std::vector<double> argument;      ///< z of Eq. DG-4, with feedback
  std::vector<double> phi;           ///< phi(z)
  std::vector<double> prediction;    ///< [unit of the output]
  Columns unmapped;                  ///< what each output map with a range was given
  std::vector<double> output_slope;  ///< of the output maps, [-]
  std::vector<double> weight;        ///< of the measurement, 0 where the model claims nothing
};

/// Bound on a prediction: a million times the output's size; without an output, as in predicting
/// from the inputs alone, 1e30.
double runaway_bound(const Signal& output);

/// Every stretch from the steady state of its first second, Eq. DG-54, the inputs alone.
/// @param with_time_only  false: without the effects that the inputs do not determine
/// (EffectKind::time_only)
FreeRun free_run(const Model& model, const Signals& signals, bool with_time_only = true);

/// The signals between which a linear body lies: the inputs as they reach it, the output without
/// terms and gain.  false: an effect is inside the body or behind it, and cannot be removed.
/// @param output  the measured one, changed
bool without_effects(const Model& model, const Signals& signals,
                     std::vector<std::vector<double>>& inputs, std::vector<double>& output);

/// A model's error and how it changes with the fitted numbers, packed()'s order, Eq. DG-9.
/// Weighted, with the initial state of every stretch fitted (projected out, Eq. DG-10), and through
/// the signals' filter, Eq. DG-61.
struct Linearisation {
  bool finite = true;
  Eigen::MatrixXd jacobian;  ///< d prediction / d numbers, [samples x numbers]
  Eigen::VectorXd residual;  ///< output - prediction, [samples]
  FreeRun run;
};

/// Exact by filtering where the model is linear in what it filters, by forward differences for
/// nonlinear parameters and for a body with feedback.
Linearisation linearised(const Model& model, const Signals& signals);

/// The residual alone, as in Linearisation.
Eigen::VectorXd residual_of(const Model& model, const Signals& signals, FreeRun& run);

/// Orthonormal free responses at the start of every stretch: removes them from a column, Eq. DG-10.
/// Of slow ones each direction that has most of its power in Signals::start_rows() is fitted to
/// these alone: a level that lasts through a fold is no knowledge of the fold.
class InitialStates {
 public:
  InitialStates(const Body& body, const Signals& signals, const std::vector<double>& weight);
  /// With the poles that effects add to the body's.
  InitialStates(const Model& model, const Signals& signals, const std::vector<double>& weight);
  void remove_from(Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// What it removes from one column.
  [[nodiscard]] Eigen::VectorXd part_of(const Eigen::VectorXd& column) const;

 private:
  InitialStates(const std::vector<double>& denominator, const Signals& signals,
                const std::vector<double>& weight);

  struct Start {
    std::size_t first;
    Eigen::MatrixXd basis;  ///< [window x order], orthonormal
    Eigen::MatrixXd dual;   ///< [window x order], by which its factors are taken
  };
  std::vector<Start> starts_;
};

/// x / A(q), every stretch from rest.
std::vector<double> through_poles(const std::vector<double>& x,
                                  const std::vector<double>& denominator,
                                  const std::vector<Stretch>& stretches);
/// B(q) x / A(q), every stretch from rest.
std::vector<double> through_path(const std::vector<double>& x, std::span<const double> numerator,
                                 const std::vector<double>& denominator,
                                 const std::vector<Stretch>& stretches);
/// x(n) - x(n-1), every stretch from rest.
std::vector<double> differenced(const std::vector<double>& x,
                                const std::vector<Stretch>& stretches);
/// x(n - lag); up to `lag` of a stretch, its first value.
std::vector<double> lagged(const std::vector<double>& x, std::size_t lag,
                           const std::vector<Stretch>& stretches);

}  // namespace stillhand::diagnosis
