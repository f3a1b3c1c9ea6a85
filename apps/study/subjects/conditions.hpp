// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <utility>

#include "apps/libraries/session/core/conditions.hpp"

/// The conditions, by which a study keeps its results; only recorded sessions have C' and C+.
namespace stillhand::study {

using session::Condition;
using enum session::Condition;
using session::kPaperConditions;

/// Those that the paper's figures show: A, B, C, and C' and C+ where a session ran them.
inline constexpr std::array kFigureConditions{kA, kB, kC, kCPrime, kCPlus};
inline constexpr std::array kCancelling{kC, kCPrime, kCPlus};

/// Steps from one canceller to the next, compared where both were run.
inline constexpr std::array<std::pair<Condition, Condition>, 3> kCancellerSteps{
    {{kC, kCPrime}, {kCPrime, kCPlus}, {kC, kCPlus}}};

/// Of a name of the table, which the program itself wrote or checked.
inline Condition named(const std::string& name) { return session::condition_named(name).value(); }

/// "C'-C+"
inline std::string pair_word(Condition from, Condition to) {
  return std::string(name_of(from)) + "-" + name_of(to);
}

}  // namespace stillhand::study
