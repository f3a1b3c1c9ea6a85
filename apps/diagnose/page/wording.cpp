// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/wording.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Diagnosis;
using diagnosis::FoundEffect;
using report::replace_all;
using report::short_number;

std::string model_name(const Diagnosis& diagnosis) {
  const std::size_t order = diagnosis.baseline.model.body.order();
  if (order == 0) return "a static linear model";
  return "a linear model of order " + std::to_string(order);
}

// "a", "a and b", "a, b and c".
std::string enumerated(const std::vector<std::string>& names) {
  if (names.size() < 2) return fmt::format("{}", fmt::join(names, ""));
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

// Of the model that is saved, and of all effects where it does not have them whole.
std::string error_in_words(const Diagnosis& diagnosis) {
  const std::string unit = diagnosis.output_unit;
  const bool none = none_carried(diagnosis);
  const diagnosis::HeldOutError& shown_error =
      none ? diagnosis.final_error : diagnosis.carried_error;
  const bool whole = std::ranges::all_of(
      diagnosis.effects, [](const FoundEffect& effect) { return effect.carried == 1.0; });
  const std::string it = diagnosis.effects.size() == 1 ? "it" : "them";
  return "With " + (whole || none ? it : "the part of " + it + " that is saved") +
         ", the RMS error on held-out data is " + shown(shown_error.rmse, unit) +
         " (95 %: " + interval(shown_error.low, shown_error.high) + ") instead of " +
         shown(diagnosis.baseline_error.rmse, unit) +
         (none    ? "; none of " + it + " is saved for other recordings"
          : whole ? ""
                  : "; with all of " + it + ", " + shown(diagnosis.final_error.rmse, unit)) +
         ". The noise floor is " + shown(diagnosis.noise_floor.rmse, unit) + " (" +
         interval(diagnosis.noise_floor.low, diagnosis.noise_floor.high) + ").";
}

// The largest size at which a kind is missed as often as found, and which.
std::string hardest_to_find(const Diagnosis& diagnosis) {
  const diagnosis::PlantedLimit& hardest =
      *std::ranges::max_element(diagnosis.limits, {}, &diagnosis::PlantedLimit::half);
  if (!std::isfinite(hardest.half)) return " (a " + spaced(hardest.kind) + " hardly ever)";
  return " (a " + spaced(hardest.kind) + " only if it adds " +
         shown(hardest.half, diagnosis.output_unit) + " in all)";
}

std::string limit_in_words(const Diagnosis& diagnosis) {
  if (diagnosis.detection_limit <= 0.0)
    return "No effect that was planted into it is found either.";
  return "An effect that adds " + shown(diagnosis.detection_limit, diagnosis.output_unit) +
         " RMS that a linear model cannot imitate is found as often as not" +
         hardest_to_find(diagnosis) + "; a smaller one may be there.";
}

}  // namespace

std::string interval(double low, double high) {
  return short_number(low) + " to " + short_number(high);
}

std::string shown_unit(std::string_view unit) {
  std::string text(unit);
  const auto is_of = [&](const std::string& name) {
    return text == name || text.starts_with(name + "/") || text.starts_with(name + "^");
  };
  if (is_of("deg")) replace_all(text, "deg", "°");
  if (text.ends_with("/deg")) replace_all(text, "/deg", "/°");
  if (is_of("us")) text.replace(0, 2, "µs");
  replace_all(text, "degC", "°C");
  replace_all(text, "^2", "²");
  replace_all(text, "^3", "³");
  replace_all(text, "*", "·");
  return text;
}

std::string shown(double value, std::string_view unit) {
  if (diagnosis::is_plain_unit(unit)) return short_number(value);
  return short_number(value) + " " + shown_unit(unit);
}

std::string axis_label(std::string_view name, std::string_view unit) {
  if (unit.empty()) return std::string(name);
  return std::string(name) + " [" + shown_unit(unit) + "]";
}

std::string unit_ratio(std::string_view over, std::string_view under) {
  return shown_unit(diagnosis::unit_over(over, under));
}

std::string shown_sentence(std::string_view sentence, std::string_view output_unit) {
  std::string text(sentence);
  replace_all(text, "(output unit per channel unit)",
              shown_unit(output_unit) + " per unit of the channel");
  replace_all(text, "(output unit)", shown_unit(output_unit));
  replace_all(text, "+-", "±");
  replace_all(text, " us ", " µs ");
  replace_all(text, " -", " −");
  return text;
}

std::string spaced(std::string_view kind) {
  std::string text(kind);
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string effect_title(const FoundEffect& effect) {
  const std::string kind = spaced(effect.effect.kind);
  return effect.channel.empty() ? kind : kind + " (" + effect.channel + ")";
}

std::string carried_in_words(const FoundEffect& effect) {
  if (effect.carried == 1.0)
    return "saved: it needs the inputs alone, so it can predict another recording";
  const std::string why = effect.why_not_carried.empty() ? "" : ": " + effect.why_not_carried;
  return (effect.carried > 0.0 ? "saved to " + percent(effect.carried, 0) : "not saved") + why;
}

bool none_carried(const Diagnosis& diagnosis) {
  return diagnosis.has_effect_that_counts() &&
         std::ranges::none_of(diagnosis.effects,
                              [](const FoundEffect& effect) { return effect.carried > 0.0; });
}

std::string too_small_in_words(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const FoundEffect& effect : diagnosis.effects) {
    if (effect.counts) continue;
    names.push_back(effect_title(effect) + " of " +
                    shown(effect.explained.rms, diagnosis.output_unit) + " RMS");
  }
  if (names.empty()) return {};
  return "Found and too small to count: " + enumerated(names) + ", less than " +
         shown(diagnosis.options.least_force_n, "N") + " (--least-force).";
}

std::string verdict_in_words(const Diagnosis& diagnosis) {
  const std::string model = model_name(diagnosis);
  if (diagnosis.no_model) {
    return "No model (" + diagnosis.no_model->reason + "): " + diagnosis.no_model->why + ".";
  }
  const std::string too_small = too_small_in_words(diagnosis);
  if (diagnosis.has_effect_that_counts()) {
    std::vector<std::string> names;
    double largest_p = 0.0;
    bool tied = false;
    for (const FoundEffect& effect : diagnosis.effects) {
      if (!effect.counts) continue;
      names.push_back(effect_title(effect));
      largest_p = std::max(largest_p, effect.p);
      tied = tied || !effect.ties.empty();
    }
    return "Effects found: " + model + " lacks " + enumerated(names) +
           (diagnosis.unexplained ? ", and something that no kind of effect explains" : "") + ". " +
           (too_small.empty() ? "" : too_small + " ") + error_in_words(diagnosis) +
           " Chance alone improves the blocks " +
           (names.size() == 1 ? "as much" : "as the smallest of them does") +
           " with a probability of " + p_value(largest_p) +
           ", the choice among the candidates not counted." +
           (tied ? " Other kinds are tied with them on this recording: see \"ties\" in the table "
                   "of effects."
                 : "");
  }
  const std::string left = shown(diagnosis.baseline_error.rmse, diagnosis.output_unit) +
                           " RMS on held-out data (95 %: " +
                           interval(diagnosis.baseline_error.low, diagnosis.baseline_error.high) +
                           ")";
  if (diagnosis.unexplained) {
    return "Unexplained residual: " + model +
           " leaves more than noise, and no kind of effect explains it. The residual depends on a "
           "quantity that was tested; chance does not do that. The model leaves an error of " +
           left + "; the noise floor is " +
           shown(diagnosis.noise_floor.rmse, diagnosis.output_unit) + ".";
  }
  if (diagnosis.options.search.most_effects == 0) {
    return "No effect was looked for (--most-effects 0). " + model + " leaves " + left + ".";
  }
  if (!too_small.empty()) {
    return "Nothing missing that counts. " + too_small + " " + error_in_words(diagnosis);
  }
  return "Nothing missing: no effect reduces the error of " + model +
         " by more than chance does. " + limit_in_words(diagnosis) + " What is left is " + left +
         ". It depends on none of the quantities that were tested.";
}

std::string stability_in_words(const diagnosis::NameCounts& stability) {
  std::vector<std::string> words;
  for (const auto& [verdict, count] : stability.counts) {
    words.push_back(fmt::format("{} ({})", spaced(verdict), count));
  }
  return fmt::format("{} repetitions without a fifth of the recording end in {}",
                     stability.repetitions, fmt::join(words, ", "));
}

std::string draws_in_words(const diagnosis::NameCounts& draws) {
  std::vector<std::string> words;
  for (const auto& [name, count] : draws.counts) {
    words.push_back(
        fmt::format("{}{} in {}", spaced(name), words.empty() ? " is named" : "", count));
  }
  return fmt::format("Of {} draws of the recording's blocks, {}", draws.repetitions,
                     fmt::join(words, ", "));
}

}  // namespace stillhand::diagnose
