// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "apps/study/explain/inference.hpp"

namespace stillhand::study {

/// The paper's second residual: people who differ more in C than ours; METHOD Eq. SU-23 to SU-25.

/// Standard deviations between subjects of A - B, then of B - C, by metric.
using Deviations = std::array<double, 6>;
Deviations deviations_of(const std::vector<Metrics>& subjects);
/// The paper's, from its p-values.
Deviations paper_deviations(const PaperTables& paper);

/// An index of spread_causes() and a value of its parameter.
using AtValue = std::pair<std::size_t, double>;

/// The chain with causes of spread, next to the paper's tables.
struct SpreadFit {
  std::string name;
  std::vector<AtValue> causes;
  TableVector z;                   ///< against the paper, in its standard errors
  std::array<double, 3> z_of_c{};  ///< of the means of C, in the standard errors of B - C
  Deviations over_paper{};         ///< deviations over the paper's
  double given = 0.0;              ///< share of the missing deviation of B - C, Eq. SU-24
  double low = 0.0, high = 0.0;    ///< 95 % of other such people
  bool holds = false;              ///< the means stay, Eq. SU-24
  double log_likelihood = 0.0;     ///< of the paper's tables, nothing calibrated again
};

/// What a laboratory could measure in people who repeat B and C, Eq. SU-25.
struct Signature {
  const char* name;
  bool correlation;  ///< otherwise a deviation, or a ratio of two
};
inline constexpr std::array<Signature, 8> kSignatures{
    {{"RMS error: B-C with a second B-C", true},
     {"f_c: B-C with a second B-C", true},
     {"RMS error: B-C with the force cancelled", true},
     {"f_c: C-B with C's place after B", true},
     {"RMS error: C with B", true},
     {"SD of ln motor force over feedthrough force", false},
     {"SD of the delay of the counterforce [ms]", false},
     {"RMS error: SD of C over SD of B", false}}};
using SignatureValues = std::array<double, kSignatures.size()>;

SignatureValues signatures_of(const std::vector<Response>& first,
                              const std::vector<Response>& second);

/// People for whom a signature is unlike another in four studies of five, at a level of 0.05.
double people_needed(std::size_t signature, double value, double other);

/// The signature that needs the fewest, and how many.
std::pair<std::size_t, double> tells_apart(const SignatureValues& one,
                                           const SignatureValues& other);

/// On people who had no part in the choice, without any linear step.
struct SpreadJudged {
  SpreadFit fit;
  std::array<std::array<double, 2>, 6> ratio_ci95{};  ///< of `over_paper`, both samples finite
  SignatureValues signatures{};
};

struct Spread {
  std::size_t subjects = 0;
  std::uint64_t seed = 0;         ///< of the choice
  std::uint64_t judged_seed = 0;  ///< of `judged`
  Deviations paper{};
  SpreadFit chain;                   ///< the chain alone, same people
  std::vector<SpreadFit> ranked;     ///< every cause where it gives most while the means hold
  std::vector<SpreadFit> ends;       ///< the same causes at the far end of their range
  SpreadFit combination;             ///< up to three causes, by adding up their changes
  std::vector<SpreadJudged> judged;  ///< chain, combination, then the best causes
};

/// Responses of the same people to the chain and to every cause on it.
struct SpreadResponses {
  std::vector<Response> chain;
  std::vector<CauseResponses> causes;  ///< in the order of spread_causes()
};

/// Ranks the causes and chooses the combination; everything but `judged`.
Spread rank_spread(const SpreadResponses& responses, const PaperTables& paper);

/// A simulated population next to the paper's tables.
SpreadFit fit_spread(const std::vector<Metrics>& subjects, const std::vector<Metrics>& chain,
                     const PaperTables& paper);

}  // namespace stillhand::study
