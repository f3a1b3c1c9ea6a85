// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/whose.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::study {
namespace {

// P(K <= most), K of `of` with the share.
double at_most(std::size_t most, std::size_t of, double share) {
  double sum = 0.0;
  double term = std::pow(1.0 - share, static_cast<double>(of));
  for (std::size_t k = 0; k <= most; ++k) {
    sum += term;
    term *= static_cast<double>(of - k) / static_cast<double>(k + 1) * share / (1.0 - share);
  }
  return sum;
}

bool has(const PersonDiagnosis& person, const RecurringEffect& effect) {
  return std::ranges::any_of(person.findings, [&](const close_the_loop::Finding& finding) {
    return finding.kind == effect.kind && finding.channel == effect.channel &&
           finding.where == effect.where;
  });
}

}  // namespace

Whose whose(std::size_t have, std::size_t able) {
  constexpr double kError = 0.05;
  constexpr double kHalf = 0.5;
  constexpr double kPower = 0.8;  // with which an effect of everybody is found in one person
  if (have > 0 && 1.0 - at_most(have - 1, able, kHalf) < kError) return Whose::kRig;
  return at_most(have, able, kPower) < kError ? Whose::kPerson : Whose::kOpen;
}

double newcomers_chance(const RecurringEffect& effect) {
  return static_cast<double>(effect.participants.size() + 1) / static_cast<double>(effect.able + 2);
}

double share_of(const Diagnoses& diagnoses, Whose owner) {
  double of_owner = 0.0;
  double all = 0.0;
  for (const auto& [code, person] : diagnoses.people) {
    for (const RecurringEffect& effect : diagnoses.recurring) {
      for (const close_the_loop::Finding& finding : person.findings) {
        if (finding.kind != effect.kind || finding.channel != effect.channel ||
            finding.where != effect.where) {
          continue;
        }
        const double square = finding.explained_n * finding.explained_n;
        all += square;
        if (effect.whose == owner) of_owner += square;
      }
    }
  }
  return all > 0.0 ? of_owner / all : 0.0;
}

std::vector<LeftOutPerson> leave_one_out(const std::map<std::string, PersonDiagnosis>& people) {
  std::vector<LeftOutPerson> out;
  for (const auto& [code, person] : people) {
    std::map<std::string, PersonDiagnosis> others = people;
    others.erase(code);
    LeftOutPerson left{code, person.findings.size()};
    for (const RecurringEffect& effect : recurring_in(others)) {
      if (2 * effect.participants.size() <= others.size()) continue;
      ++(has(person, effect) ? left.forecast : left.false_ones);
    }
    out.push_back(left);
  }
  return out;
}

}  // namespace stillhand::study
