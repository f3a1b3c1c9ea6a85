// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "services/core/diagnosis/fitting/held_out.hpp"

/// The choice among the models that were tried, METHOD "Selection".
namespace stillhand::diagnosis {

/// Settings of the search; METHOD "Selection" gives the reason of each number.
struct SearchOptions {
  std::size_t most_effects = 4;
  double first_least_fall = 0.005;  ///< [-] of the held-out error: is anything missing at all?
  double least_fall = 0.01;     ///< [-] later: an imperfect form of the first leaves about as much
  double significance = 0.001;  ///< [-] divided by the number of candidates (Bonferroni)
  double large_fall = 0.15;     ///< [-] of the held-out error: significance not divided,
  double large_significance = 0.01;  ///< [-] and this one
  double tie = 0.03;                 ///< [-] of the held-out error,
  double tied_gain = 0.95;           ///< [-] and of the gain: the simpler wins
  int screening_iterations = 5;
  int fit_iterations = 30;
};

/// Held-out errors of two models compared block by block, METHOD Eq. DG-16.
struct Comparison {
  double rmse_ratio = 1.0;  ///< [-] after / before
  double t = 0.0;           ///< [-] mean of the blocks' differences over its standard error
  double p = 1.0;           ///< [-] of such signs and ranks by chance: Wilcoxon's signed-rank test
};

Comparison compared(const HeldOut& before, const HeldOut& after);

/// A model that was tried.
struct Trial {
  Model model;
  HeldOut held_out;
  double rmse = 0.0;      ///< held out
  bool own_body = false;  ///< it started from a body that was estimated for it
  bool fitted = true;     ///< no: the screening shows that nothing is to be gained
  /// [-] of as large a share of surrogates of the residual, Eq. DG-94; 0: not asked.
  double surrogate_p = 0.0;
};

bool by_rmse(const Trial& a, const Trial& b);
/// True when the last effect leaves samples out and explains none.
bool passes_over_samples(const Trial& trial);

/// True when surrogates of the residual give as much: it is not chosen.
bool is_by_chance(const Trial& trial);

/// True when the residual is no more than rounding of the output's own numbers.
bool is_rounding(double rmse, const Signals& signals);

/// True when it explains as much as the best: the blocks do not distinguish them (one standard
/// error), or its error is hardly larger and it has nearly all of the gain, Eq. DG-17.
/// @param current_rmse  held out, without any of them
bool ties_with(const Trial& other, const Trial& best, double current_rmse,
               const SearchOptions& options);
/// The best that earns its numbers, Eq. DG-50, or the simplest that ties with it, Eq. DG-17.
/// @param current_rmse  held out, without any of them
/// @param worth_adding  asked of one that is to be named in place of one with a smaller error
std::size_t chosen_of(const std::vector<Trial>& tried, double current_rmse,
                      const SearchOptions& options,
                      const std::function<bool(const Trial&)>& worth_adding = {});
/// True when it is to be added if it is chosen, Eq. DG-17 and DG-89.
/// @param current  held out, without any of them
/// @param candidates  so many were tried
bool is_worth_adding(const Trial& trial, const HeldOut& current, double least_fall,
                     std::size_t candidates, const SearchOptions& options);
/// The one to be added: the chosen one, or the first that the rows show; their number if there is
/// none.
std::size_t added_of(const std::vector<Trial>& tried, const HeldOut& current, double least_fall,
                     std::size_t candidates, const SearchOptions& options);
/// Other kinds that tie with the chosen one.
std::vector<std::string> tied_kinds(const std::vector<Trial>& tried, std::size_t chosen,
                                    double current_rmse, const SearchOptions& options);
/// True when an improvement is large and certain enough, Eq. DG-17.
bool worth_it(const Comparison& comparison, const SearchOptions& options, double least_fall,
              std::size_t candidates);

}  // namespace stillhand::diagnosis
