// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace stillhand::settings {

/// A check for an option of a command line: a decimal number from `low` to `high`, both included.
/// Unlike Option::between() it refuses NaN.  @return "" for a good word, else one sentence
std::function<std::string(const std::string& word)> number_between(double low, double high);

}  // namespace stillhand::settings
