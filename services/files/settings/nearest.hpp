// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillhand::settings {

/// The candidate nearest to a misspelt word by edit distance (Levenshtein 1966); the first of
/// several; empty without candidates.
std::string nearest(std::string_view word, std::span<const std::string_view> candidates);

/// What a message says to a word that is none of the candidates, which are not empty: "\"name\"
/// perhaps", if no more than a third of its letters are others, else "one of name, mass_kg".
std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace stillhand::settings
