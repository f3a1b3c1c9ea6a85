// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

/// Starts for a nonlinearity inside the body (Eq. DG-4) from a fit with another one: a spring that
/// softens and one with play have the same linear parts, and only the fit that got there knows
/// them.
namespace stillhand::diagnosis {

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

}  // namespace stillhand::diagnosis
