// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/core/statistics/ratio.hpp"

namespace stillhand::compare {

using session::Number;

/// The numbers that are judged; every summary holds them.
inline constexpr auto kMetrics = [] {
  std::array<Number, std::ranges::count_if(session::kNumbers, &Number::is_judged)> judged{};
  std::ranges::copy_if(session::kNumbers, judged.begin(), &Number::is_judged);
  return judged;
}();

/// One value for each person; NaN: not known.
using PerMetric = std::array<std::vector<double>, kMetrics.size()>;

struct Condition {
  std::string label;  ///< "A", "C+"
  PerMetric values;
};

/// A study or session.
struct Side {
  std::string name;
  std::vector<Condition> conditions;

  [[nodiscard]] const Condition* find(const std::string& label) const noexcept;
};

/// How one metric is under one option.  Of the people with a value.
struct Outcome {
  std::size_t people = 0;
  double mean = 0.0;
  std::optional<statistics::MeanInterval> interval;  ///< two people or more
  /// Eq. CO-1, with A and B of the same side.
  statistics::RestoredShare restored;
  std::size_t compared = 0;           ///< people with a value in B too
  std::optional<std::size_t> harmed;  ///< of these, whom it leaves worse than B
  std::optional<double> least_gain;   ///< of the worst person over B, + better
};

/// Something that can be used while the platform moves: a condition of a side, without A and B.
struct Option {
  std::size_t side = 0;
  std::string condition;
  std::array<Outcome, kMetrics.size()> outcomes;
};

/// The best option of a metric against another one, Eq. CO-2.
struct Contrast {
  std::size_t other = 0;  ///< index of the option
  bool same_people = false;
  double better_by = 0.0;        ///< mean difference, + : the best one is better
  double low = 0.0, high = 0.0;  ///< 95 %
  double p = 1.0;                ///< two-sided, after Holm over the metric's contrasts
};

struct Ranking {
  std::optional<std::size_t> best;  ///< of the means; none without a value
  std::vector<Contrast> contrasts;  ///< where each has two people or more
  /// Options that the data do not tell apart from the best: p of 0.05 or more, or no test.
  std::vector<std::size_t> as_good;
};

struct Comparison {
  std::vector<Side> sides;
  std::vector<Option> options;
  std::array<Ranking, kMetrics.size()> rankings;
};

/// Compares every option of every side.  README Eq. CO-1, CO-2.
Comparison compared(std::vector<Side> sides);

/// Two sides have the same people in the same rides: as many, and at least half of them have the
/// same tracking error in A, bit for bit.  Not all: a hand that met the motor before A may differ
/// in the last digits.
bool same_people(const Side& first, const Side& second) noexcept;

}  // namespace stillhand::compare
