// SPDX-License-Identifier: Apache-2.0
// Written by exact_lambda.py; see ORIGIN.md.
#pragma once

namespace stillhand::golden::statistics {

struct ExactLambda {
  int set, subjects, conditions, metrics;
  double condition, subject;
};
inline constexpr ExactLambda kExactLambdas[] = {
    {1, 20, 3, 3, 0.0007399814460781507, 0.0009001727542347622},
    {2, 9, 6, 4, 0.43345299275430876, 0.23704569411173979},
    {2, 6, 2, 5, 5.542463582880739e-05, 1.4860649719743875e-07},
};

}  // namespace stillhand::golden::statistics
