// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "services/core/diagnosis/model/effect.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"
#include "services/core/diagnosis/model/steady_start.hpp"

namespace stillhand::diagnosis {

/// How a nonlinearity phi sits in the body of order p, METHOD Eq. DG-4; e, n, m are its
/// coefficients in the difference basis D = 1 - q^-1:
///
///   A y_b = B u + E phi(z)
///   "of the output":  z = y_b,                E = q^-1 sum_{i<p} e_i D^i          (p numbers)
///   "inside":         A z = N u + M phi(z),   E = sum_{i<=p} e_i D^i, N alike,
///                                             M = q^-1 sum_{i<p} m_i D^i         (3p + 2)
///   a stop:           z = y_b before it,      E = -1                             (none)
///
/// M without a term of its own sample: no algebraic loop.
struct LoopPath {
  std::vector<double> e;  ///< by powers of q^-1, p + 1
  std::vector<double> n;  ///< p + 1, empty: z = y_b
  std::vector<double> m;  ///< p + 1, the first 0

  [[nodiscard]] bool of_output() const noexcept { return n.empty(); }
  /// P of A z = .. + P phi(z), by powers of q^-1.
  [[nodiscard]] std::vector<double> to_argument(const std::vector<double>& denominator) const;
};

/// A body, the effect that feeds back in it, and what reaches it, by input.
struct LoopCase {
  const Body* body = nullptr;
  const Effect* feedback = nullptr;
  const std::vector<Settled>* inputs = nullptr;
};

/// Signals in the loop, each as long as the measurement.
struct LoopRun {
  bool finite = true;                 ///< false: it ran away
  std::vector<double> output;         ///< y_b
  std::vector<double> argument;       ///< z
  std::vector<double> phi;            ///< phi(z)
  std::vector<double> output_before;  ///< [stretches] level of y_b before each
  std::vector<double> phi_before;     ///< [stretches] of phi(z)
};

/// Coefficients that a feedback effect of this nonlinearity has for a body of this order.
bool fits_loop(std::size_t coefficients, const Nonlinearity& nonlinearity, std::size_t order);
/// The effect next to a body of another order: polynomials by the order (of a feedback, of a term
/// through the body) lose their highest differences or get zeros.  A start for a fit.
Effect at_order(Effect effect, std::size_t from, std::size_t to);
/// E times the effect's share, Eq. DG-68.
LoopPath loop_path(const Effect& effect, std::size_t order);

/// As many cases take hardly longer than one.
inline constexpr std::size_t kLoopLanes = 4;

/// Runs bodies with their nonlinearity, every stretch from the steady state of its inputs'
/// levels, Eq. DG-54.  An effect with a range holds phi at its edges, Eq. DG-56.
/// @param cases  one structure (orders, effects) with different numbers
/// @param runs  as many
void run_loops(std::span<const LoopCase> cases, const Signals& signals, std::span<LoopRun> runs);

}  // namespace stillhand::diagnosis
