// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/core/diagnosis/fitting/screening.hpp"

/// Small parts of proposals that several kinds share.
namespace stillhand::diagnosis {

/// The better ones of some proposals, best first.
std::vector<Proposal> best_of(std::vector<Proposal> proposals, std::size_t count);

/// Puts more proposals behind others.
void append(std::vector<Proposal>& to, std::vector<Proposal> more);

/// The response of a path with the body's poles and another numerator to a signal.
std::vector<double> response_of(const Screening& screening, std::span<const double> numerator,
                                const std::vector<double>& input);
/// The response of the body to a signal in place of its first input.
std::vector<double> response_of(const Screening& screening, const std::vector<double>& input);

/// Standard deviation about the mean.
double deviation_of(const std::vector<double>& values);

/// The value below which a share of the values lies.
double quantile_of(std::vector<double> values, double share);

/// Of a limit: tanh in place of a corner.
inline bool is_soft(const Effect& effect) { return effect.form.starts_with("soft"); }

/// Number and unit, for evidence: "3.2 N".
std::string with_unit(double value, const std::string& unit);

}  // namespace stillhand::diagnosis
