// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/diagnosis_json.hpp"

#include <fmt/ranges.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "apps/diagnose/detection_json.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/measurement/screening_json.hpp"
#include "apps/libraries/report/or_null.hpp"
#include "services/core/diagnosis/share_words.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Diagnosis;
using diagnosis::FoundEffect;
using nlohmann::ordered_json;
using report::or_null;

std::string inputs_of(const Diagnosis& diagnosis) {
  return fmt::format("{}", fmt::join(diagnosis.options.inputs, ","));
}

ordered_json parameters_json(const FoundEffect& found) {
  ordered_json json = ordered_json::object();
  for (const diagnosis::Size& size : found.sizes) {
    ordered_json& each = json[size.name];
    each = {{"value", or_null(size.value)},
            {"std_error", or_null(size.std_error)},
            {"unit", size.unit}};
    if (size.at_hz) each["at_hz"] = *size.at_hz;
    if (!size.meaning.empty()) each["meaning"] = size.meaning;
  }
  return json;
}

// Coefficients only where the kind derives nothing: "friction_force 1.52 +- 0.03 N".
std::string sizes_in_words(const FoundEffect& found) {
  std::vector<std::string> words;
  const bool derived = !found.sizes.empty() && found.sizes.front().origin == "derived";
  for (const diagnosis::Size& size : found.sizes) {
    if (size.origin == "given" || (derived && size.name.starts_with("coefficient"))) continue;
    std::string each = fmt::format("{} {:.4g}", size.name, size.value);
    if (std::isfinite(size.std_error)) each += fmt::format(" +- {:.2g}", size.std_error);
    if (!diagnosis::is_plain_unit(size.unit)) each += " " + size.unit;
    if (size.at_hz) each += fmt::format(" at {:.3g} Hz", *size.at_hz);
    // Two standard errors that reach 0.
    if (2.0 * size.std_error > std::abs(size.value)) each += " (hardly determined)";
    words.push_back(std::move(each));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

// True, false, or the share.
ordered_json carried_json(double share) {
  if (share > 0.0 && share < 1.0) return share;
  return share > 0.0;
}

// Its size in newtons; null for an output in another unit.
ordered_json force_json(const Diagnosis& diagnosis, const FoundEffect& found) {
  if (diagnosis.output_unit != "N") return nullptr;
  return {{"value", found.explained.rms}, {"ci95", {found.explained.low, found.explained.high}}};
}

// The same as a line of the table.
std::string force_text(const Diagnosis& diagnosis, const FoundEffect& found) {
  const std::string text =
      fmt::format("it explains {:.3g} {} RMS (95 %: {:.3g} to {:.3g})", found.explained.rms,
                  diagnosis.output_unit, found.explained.low, found.explained.high);
  if (found.counts) return text;
  return fmt::format("{}; does not count: less than {:.3g} N (--least-force)", text,
                     diagnosis.options.least_force_n);
}

ordered_json effect_json(const Diagnosis& diagnosis, const FoundEffect& found) {
  return {{"kind", found.effect.kind},
          {"channel", or_null(found.channel)},
          {"parameters", parameters_json(found)},
          {"heldout_rmse_before", found.before.rmse},
          {"heldout_rmse_after", found.after.rmse},
          {"ci95", {found.after.low, found.after.high}},
          {"force_n", force_json(diagnosis, found)},
          {"counts", found.counts},
          {"evidence", shown_sentence(found.evidence, diagnosis.output_unit)},
          {"form", found.effect.form},
          {"signals", found.effect.channels},
          {"p", found.p},
          {"ties", found.ties},
          {"carried", carried_json(found.carried)},
          {"why_not_carried", or_null(found.why_not_carried)}};
}

ordered_json error_json(const diagnosis::HeldOutError& error) {
  return {{"heldout_rmse", error.rmse},
          {"vaf_percent", error.vaf_percent},
          {"ci95", {error.low, error.high}}};
}

ordered_json no_model_json(const Diagnosis& diagnosis) {
  if (!diagnosis.no_model) return nullptr;
  return {{"reason", diagnosis.no_model->reason}, {"why", diagnosis.no_model->why}};
}

// Outputs in other units have no threshold.
double least_force_json(const Diagnosis& diagnosis) {
  return diagnosis.output_unit == "N" ? diagnosis.options.least_force_n : 0.0;
}

ordered_json baseline_json(const Diagnosis& diagnosis) {
  const auto& body = diagnosis.baseline.model.body;
  ordered_json json{{"model", diagnosis.model_class},
                    {"heldout_rmse", diagnosis.baseline_error.rmse},
                    {"vaf_percent", diagnosis.baseline_error.vaf_percent},
                    {"ci95", {diagnosis.baseline_error.low, diagnosis.baseline_error.high}},
                    {"order", body.order()},
                    {"equation_error_rmse", or_null(diagnosis.baseline.equation_error_rmse)},
                    {"impulse_response_rmse", or_null(diagnosis.baseline.impulse_response_rmse)}};
  return json;
}

ordered_json body_json(const diagnosis::Model& model) {
  ordered_json numerators = ordered_json::object();
  for (std::size_t k = 0; k < model.inputs.size(); ++k) {
    numerators[model.inputs[k]] = model.body.numerators[k];
  }
  return {{"numerators", numerators},
          {"denominator", model.body.denominator},
          {"offset", model.body.offset},
          {"rate_hz", model.rate_hz}};
}

ordered_json limits_json(const Diagnosis& diagnosis) {
  ordered_json json = ordered_json::object();
  for (const diagnosis::PlantedLimit& limit : diagnosis.limits) {
    ordered_json found = ordered_json::array();
    for (std::size_t i = 0; i < limit.found.size(); ++i) {
      found.push_back({{"rms", diagnosis::kPlantedSizes[i] * diagnosis.final_error.rmse},
                       {"share", limit.found[i]}});
    }
    json[limit.kind] = {{"channel", or_null(limit.channel)},
                        {"found", found},
                        {"half", or_null(limit.half)},
                        {"beyond_linear", limit.beyond_linear}};
  }
  return json;
}

ordered_json shares_json(const std::optional<diagnosis::NameCounts>& counted) {
  ordered_json shares;
  if (!counted) return shares;
  for (const auto& [name, count] : counted->counts) {
    shares[name] = static_cast<double>(count) / counted->repetitions;
  }
  return shares;
}

}  // namespace

std::string diagnosis_json(const Diagnosis& diagnosis) {
  ordered_json effects = ordered_json::array();
  for (const FoundEffect& found : diagnosis.effects) {
    effects.push_back(effect_json(diagnosis, found));
  }
  ordered_json unexplained = nullptr;
  if (diagnosis.unexplained) {
    unexplained = {{"what", diagnosis.unexplained->what},
                   {"band_hz", diagnosis.unexplained->band_hz},
                   {"times_s", diagnosis.unexplained->times_s},
                   {"channels", diagnosis.unexplained->channels}};
  }
  ordered_json estimates = ordered_json::object();
  for (const diagnosis::NoiseEstimate& each : diagnosis.noise_floor.estimates) {
    estimates[each.name] = each.rmse;
  }
  const ordered_json json{{"input", inputs_of(diagnosis)},
                          {"output", diagnosis.options.output},
                          {"output_unit", diagnosis.output_unit},
                          {"sample_rate_hz", diagnosis.sample_rate_hz},
                          {"baseline", baseline_json(diagnosis)},
                          {"noise_floor_rmse", diagnosis.noise_floor.rmse},
                          {"noise_floor",
                           {{"low", diagnosis.noise_floor.low},
                            {"high", diagnosis.noise_floor.high},
                            {"method", diagnosis.noise_floor.method},
                            {"estimates", estimates}}},
                          {"detection_limit", or_null(diagnosis.detection_limit)},
                          {"detection_limits", limits_json(diagnosis)},
                          {"verdict", diagnosis.verdict()},
                          {"drawn_names", shares_json(diagnosis.drawn_names)},
                          {"stability", shares_json(diagnosis.stability)},
                          {"no_model", no_model_json(diagnosis)},
                          {"screening", measurement::screening_json(diagnosis.screening)},
                          {"least_force_n", least_force_json(diagnosis)},
                          {"effects", effects},
                          {"final", error_json(diagnosis.final_error)},
                          {"carried", error_json(diagnosis.carried_error)},
                          {"unexplained", unexplained},
                          {"detection",
                           {{"least_share", diagnosis::kLeastShare},
                            {"significance", diagnosis::kSignificance},
                            {"before", detection_json(diagnosis.before)},
                            {"after", detection_json(diagnosis.after)}}},
                          {"body", body_json(diagnosis.model)},
                          {"notes", diagnosis.notes}};
  return json.dump(2) + "\n";
}

std::string diagnosis_table(const Diagnosis& diagnosis) {
  const std::string& unit = diagnosis.output_unit;
  std::string text;
  const auto add = [&text]<class... T>(fmt::format_string<T...> format, T&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<T>(values)...);
  };
  const auto add_error = [&](const char* name, const diagnosis::HeldOutError& error,
                             const char* how) {
    add("{:<14}RMS error {:.4g} {}, {}{}\n", name, error.rmse, unit,
        diagnosis::vaf_in_words(error.vaf_percent), how);
  };
  add("verdict       {}{}\n", diagnosis.verdict(),
      !diagnosis.no_model && none_carried(diagnosis)
          ? ", none of which can be used for another recording: --save writes the linear model"
      : !diagnosis.no_model && diagnosis.options.search.most_effects == 0
          ? "; no effect was looked for (--most-effects 0)"
          : "");
  if (diagnosis.drawn_names && !diagnosis.effects.empty()) {
    add("draws         {}\n", draws_in_words(*diagnosis.drawn_names));
  }
  if (diagnosis.stability) add("stability     {}\n", stability_in_words(*diagnosis.stability));
  if (diagnosis.no_model) {
    add("              {}: {}\n", diagnosis.no_model->reason, diagnosis.no_model->why);
  } else if (!diagnosis.has_effect_that_counts() && !diagnosis.effects.empty()) {
    add("              {}\n", too_small_in_words(diagnosis));
  }
  add("model         {} from {} to {}, order {}, at {:.4g} Hz\n", diagnosis.model_class,
      inputs_of(diagnosis), diagnosis.options.output, diagnosis.baseline.model.body.order(),
      diagnosis.sample_rate_hz);
  add_error("baseline", diagnosis.baseline_error,
            " (from the inputs alone, on data that the fit has not seen; "
            "VAF: share of the variance explained)");
  for (std::size_t e = 0; e < diagnosis.effects.size(); ++e) {
    const FoundEffect& found = diagnosis.effects[e];
    const std::string of = found.channel.empty() ? "" : " (" + found.channel + ")";
    add("effect {}      {}{}: {:.4g} -> {:.4g} {} (95 %: {:.4g} to {:.4g})\n", e + 1,
        found.effect.kind, of, found.before.rmse, found.after.rmse, unit, found.after.low,
        found.after.high);
    add("              {}\n", shown_sentence(found.evidence, diagnosis.output_unit));
    if (!found.sizes.empty()) add("              {}\n", sizes_in_words(found));
    add("              {}\n", force_text(diagnosis, found));
    add("              {}\n", carried_in_words(found));
  }
  add_error("final", diagnosis.final_error, diagnosis.effects.empty() ? "" : " (with all effects)");
  if (!diagnosis.effects.empty()) {
    add_error("saved", diagnosis.carried_error,
              " (with what can predict another recording: the model of --save)");
  }
  add("noise floor   {:.4g} {} ({:.4g} to {:.4g}), the estimated error of a perfect model\n",
      diagnosis.noise_floor.rmse, unit, diagnosis.noise_floor.low, diagnosis.noise_floor.high);
  if (diagnosis.unexplained) {
    add("unexplained   {}\n", diagnosis.unexplained->what);
  }
  for (const std::string& note : diagnosis.notes) add("note          {}\n", note);
  return text;
}

}  // namespace stillhand::diagnose
