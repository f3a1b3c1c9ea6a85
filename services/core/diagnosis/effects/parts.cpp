// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/effects/parts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/record/digits.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::diagnosis {

std::vector<Proposal> best_of(std::vector<Proposal> proposals, std::size_t count) {
  std::ranges::stable_sort(proposals, std::ranges::greater(), &Proposal::gain);
  if (proposals.size() > count) proposals.resize(count);
  return proposals;
}

void append(std::vector<Proposal>& to, std::vector<Proposal> more) {
  std::ranges::move(more, std::back_inserter(to));
}

std::vector<double> response_of(const Screening& screening, std::span<const double> numerator,
                                const std::vector<double>& input) {
  return through_path(input, numerator, screening.model().body.denominator,
                      screening.signals().stretches());
}

std::vector<double> response_of(const Screening& screening, const std::vector<double>& input) {
  return response_of(screening, screening.model().body.numerators.front(), input);
}

double deviation_of(const std::vector<double>& values) {
  return std::sqrt(signal::variance(values));
}

double quantile_of(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

std::string with_unit(double value, const std::string& unit) {
  constexpr int kDigits = 3;
  return digits(value, kDigits) + (unit.empty() || unit == "-" ? "" : " " + unit);
}

}  // namespace stillhand::diagnosis
