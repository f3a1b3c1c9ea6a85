// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/wording.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/report/text.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Diagnosis;
using diagnosis::FoundEffect;
using report::short_number;

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

bool is_plain(std::string_view unit) { return unit.empty() || unit == "-" || unit == "1"; }

bool is_compound(std::string_view unit) { return unit.find_first_of("/* ") != std::string::npos; }

std::string model_name(const Diagnosis& diagnosis) {
  const std::size_t order = diagnosis.baseline.model.body.order();
  if (order == 0) return "a static linear model";
  return "a linear model of order " + std::to_string(order);
}

std::string capital(std::string text) {
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') text.front() -= 'a' - 'A';
  return text;
}

// "a", "a and b", "a, b and c".
std::string enumerated(const std::vector<std::string>& names) {
  if (names.size() < 2) return fmt::format("{}", fmt::join(names, ""));
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

std::string error_in_words(const Diagnosis& diagnosis) {
  const std::string unit = diagnosis.output_unit;
  return "the RMS error on held-out data falls from " + shown(diagnosis.baseline_error.rmse, unit) +
         " to " + shown(diagnosis.final_error.rmse, unit) +
         " (95 %: " + interval(diagnosis.final_error.low, diagnosis.final_error.high) +
         "); the noise floor is " + shown(diagnosis.noise_floor.rmse, unit) + " (" +
         interval(diagnosis.noise_floor.low, diagnosis.noise_floor.high) + ")";
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
  if (is_of("us")) text.replace(0, 2, "µs");
  replace_all(text, "degC", "°C");
  replace_all(text, "^2", "²");
  replace_all(text, "^3", "³");
  replace_all(text, "*", "·");
  return text;
}

std::string shown(double value, std::string_view unit) {
  if (is_plain(unit)) return short_number(value);
  return short_number(value) + " " + shown_unit(unit);
}

std::string axis_label(std::string_view name, std::string_view unit) {
  if (unit.empty()) return std::string(name);
  return std::string(name) + " [" + shown_unit(unit) + "]";
}

std::string unit_ratio(std::string_view over, std::string_view under) {
  if (over == under || (is_plain(over) && is_plain(under))) return "-";
  if (is_plain(under)) return shown_unit(over);
  std::string below = shown_unit(under);
  if (is_compound(under)) below = "(" + below + ")";
  return (is_plain(over) ? "1" : shown_unit(over)) + "/" + below;
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

std::string p_value(double p) { return p > 0.0 ? short_number(p) : "< 10⁻³⁰⁰"; }

std::string percent(double share, int decimals) {
  return report::number(100.0 * share, decimals) + " %";
}

std::string verdict_in_words(const Diagnosis& diagnosis) {
  const std::string model = model_name(diagnosis);
  std::string text;
  if (!diagnosis.effects.empty()) {
    std::vector<std::string> names;
    bool tied = false;
    for (const FoundEffect& effect : diagnosis.effects) {
      names.push_back(effect_title(effect));
      tied = tied || !effect.ties.empty();
    }
    text = "Effects found. " + capital(model) + " lacks: " + enumerated(names) + ". With " +
           (names.size() == 1 ? "it " : "them ") + error_in_words(diagnosis) + ".";
    if (tied) text += " Other kinds explain some of it equally well: see the ties.";
    text += diagnosis.unexplained
                ? " A part of the residual is left that no kind of effect explains."
                : " The rest depends on none of the quantities that were tested.";
    return text;
  }
  const std::string left = shown(diagnosis.baseline_error.rmse, diagnosis.output_unit) +
                           " RMS on held-out data (95 %: " +
                           interval(diagnosis.baseline_error.low, diagnosis.baseline_error.high) +
                           ")";
  if (diagnosis.unexplained) {
    return "Unexplained residual. " + capital(model) + " leaves " + left +
           ". This is more than noise (noise floor " +
           shown(diagnosis.noise_floor.rmse, diagnosis.output_unit) +
           "), and no kind of effect explains it.";
  }
  return "Nothing missing. " + capital(model) + " leaves " + left +
         ". This residual depends on none of the quantities that were tested, and no effect "
         "reduces "
         "it by more than chance does.";
}

}  // namespace stillhand::diagnose
