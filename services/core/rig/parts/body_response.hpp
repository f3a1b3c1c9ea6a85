// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>

#include "services/core/rig/parts/body_config.hpp"

namespace stillhand::rig {

/// Biodynamic feedthrough of the linear body: load-cell force per platform acceleration with the
/// stick held, H(jw) = F'/A [N per m/s^2 = kg]; about -3.2 at 0 Hz.
/// Source: METHOD Eq. RG-6; paper Eq. 1, Fig. 6.  Pure.
/// @param relaxed       true: idle hand (pegged);  false: co-contracted (tracking)
/// @param frequency_hz  [Hz], finite, zero or more
std::complex<double> feedthrough_response(const BodyConfig& body, const StickConfig& stick,
                                          bool relaxed, double frequency_hz);

/// Displacement of the stick at the hand per force on it, with the body attached: X_j/F_t [m/N],
/// without Coulomb friction and stops.  At 0 Hz and without a centring spring it is the series
/// compliance of seat, shoulder and grip.
/// Source: METHOD Eq. RG-7.  Pure.
std::complex<double> hand_admittance(const BodyConfig& body, const StickConfig& stick, bool relaxed,
                                     double frequency_hz);

}  // namespace stillhand::rig
