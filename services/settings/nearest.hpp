// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillhand::settings {

/// The candidate nearest to a misspelt word by edit distance (Levenshtein 1966); the first of
/// several; empty without candidates.
std::string nearest(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace stillhand::settings
