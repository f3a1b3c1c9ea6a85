// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

/// Starts for a nonlinearity inside the body (Eq. DG-4) from a fit with another one: a spring that
/// softens and one with play have the same linear parts, and only the fit that got there knows
/// them.
namespace stillhand::diagnosis {

/// The reverse of loop_path(): its polynomials as coefficients of a nonlinearity inside the body.
std::vector<double> coefficients_of(const LoopPath& path);

/// True when the model's last effect is a nonlinearity inside the body.
bool ends_inside_body(const Model& model);

/// The same free run with an order more: a pole that a zero cancels in every path.  For models
/// whose last effect is inside the body and that have no other effect with coefficients by the
/// order.
Model lifted(const Model& model);

/// METHOD Eq. DG-49: the last effect's phi(z) with the nearest alpha psi(z/beta) + gamma z put in
/// its place, psi of `other`'s kind and form.
/// @return nullopt where that is unstable or runs away
std::optional<Model> with_shape_of(const Effect& other, const Model& model, const Signals& signals);

/// How well a law describes a curve.
struct Reading {
  double unread = 1.0;         ///< [-] of the curve's bend (RMS) that the law leaves
  std::optional<Model> model;  ///< with the law in the curve's place
};

/// METHOD Eq. DG-90: the last effect's curve by a law, at the best scale of its argument, with any
/// factor, slope and level.  The bend is what a straight line over z leaves of phi.
Reading read_as(const Effect& law, const Model& curve, const Signals& signals);

}  // namespace stillhand::diagnosis
