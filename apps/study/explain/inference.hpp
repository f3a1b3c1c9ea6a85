// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/explain/likelihood.hpp"

namespace stillhand::study {

/// Responses of the same subjects to every value of one cause.
struct CauseResponses {
  const Cause* cause = nullptr;
  std::vector<std::vector<Response>> at;  ///< by value of the grid, then subject; the chain's: one
};

/// Metrics of a subject with the cause at any value, linear between those of its grid.
Metrics metrics_at(const CauseResponses& cause, std::size_t subject, double value);

/// Responses that no single cause gives: both causes at one value each.
struct PairResponses {
  std::array<std::size_t, 2> causes{};  ///< indices of the causes
  std::array<double, 2> values{};
  std::vector<Response> at;  ///< by subject
};

/// A posterior, summarised.
struct Marginal {
  std::string name;
  double median = 0.0;
  double low = 0.0;  ///< 95 % interval
  double high = 0.0;
};

/// A hypothesis about the tables: no cause, one, or two.
struct Hypothesis {
  std::string name;                 ///< of the causes, joined by " + "
  std::vector<std::size_t> causes;  ///< indices
  double log_evidence = 0.0;
  std::array<double, 2> halves{};   ///< the same of each half of the subjects
  double log_evidence_error = 0.0;  ///< of log_evidence less that of no cause, from the halves
  std::vector<Marginal> parameters;
  std::vector<double> values;   ///< posterior medians, by cause; 1 for a cause without a parameter
  std::vector<double> spreads;  ///< posterior medians of the coefficients of variation, by cause
  std::vector<double> shift;    ///< of the calibrated means there
  TableVector z;                ///< (prediction - paper) / the paper's standard error there
  double fit_p = 0.0;           ///< of tables as far off; 15 degrees of freedom less the parameters
};

/// What all hypotheses share.
struct Inference {
  const std::vector<Response>* without = nullptr;  ///< no cause, by subject
  PaperTables paper;
  Nuisance nuisance;
};

/// Evidence, posterior and fit of no cause, of one and of two, Eq. SU-8 to SU-10.
Hypothesis explain_nothing(const Inference& all);
Hypothesis explain_with(const Inference& all, std::size_t index, const CauseResponses& cause);
Hypothesis explain_with(const Inference& all, const std::array<const CauseResponses*, 2>& causes,
                        const PairResponses& pair);

/// ln 20: a Bayes factor below it is not strong, Kass and Raftery (1995).
inline constexpr double kTellsApart = 2.995732273553991;

/// Names of hypotheses that the tables cannot tell from the best of `among`; empty when only the
/// best is left.
std::vector<std::string> indistinguishable(const std::vector<Hypothesis>& among);

}  // namespace stillhand::study
