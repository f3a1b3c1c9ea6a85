// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "apps/libraries/report/text/text.hpp"
#include "services/core/diagnosis/diagnose.hpp"

namespace stillhand::diagnose {

using report::p_value;
using report::percent;

/// A unit as people write it: "m/s²" for "m/s^2", "N·m" for "N*m", "°C" for "degC", "µs" for "us".
std::string shown_unit(std::string_view unit);
/// Number of three digits and unit; a number alone for "-" and for none.
std::string shown(double value, std::string_view unit);
/// "name [unit]"; the name alone where there is no unit.
std::string axis_label(std::string_view name, std::string_view unit);
/// "[unit]" of a ratio of units, for example "N/(m/s²)"; "-" where both are the same or none.
std::string unit_ratio(std::string_view over, std::string_view under);
/// The engine's sentence with the output's unit put in and signs as people write them.
std::string shown_sentence(std::string_view sentence, std::string_view output_unit);

/// "coulomb friction", with its channel where it has one: "coulomb friction (omega)".
std::string effect_title(const diagnosis::FoundEffect& effect);
std::string spaced(std::string_view kind);

/// The effects that were found and do not count, as a sentence; empty: there are none.
std::string too_small_in_words(const diagnosis::Diagnosis& diagnosis);

/// "1.2 to 3.4"
std::string interval(double low, double high);

/// "saved: it needs the inputs alone, ...", "saved to 67 %: ..." or "not saved: ...".
std::string carried_in_words(const diagnosis::FoundEffect& effect);
/// True when effects were found and the model that is saved has none of them.
bool none_carried(const diagnosis::Diagnosis& diagnosis);

/// The verdict in words, a few sentences.
std::string verdict_in_words(const diagnosis::Diagnosis& diagnosis);

/// "20 repetitions without a fifth of the recording end in hysteresis (17), dead zone (3)"
std::string stability_in_words(const diagnosis::NameCounts& stability);
/// "Of 100 draws of the recording's blocks, hysteresis is named in 83, dead zone in 17"
std::string draws_in_words(const diagnosis::NameCounts& draws);

}  // namespace stillhand::diagnose
