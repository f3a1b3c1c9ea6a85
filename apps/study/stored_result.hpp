// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <concepts>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "apps/study/subject_session.hpp"

/// The results of a subject as JSON values and back, every bit of every number.  A file that keeps
/// the bits stores them as CBOR: JSON text has no NaN.  The subject itself is not stored, because
/// the settings of the study determine it.
namespace stillhand::study::stored {

template <typename Self, typename Type>
concept Is = std::same_as<std::remove_const_t<Self>, Type>;

// parts(): the fields of each type, once for both directions.
void parts(auto&& visit, Is<signal::DifferenceModel> auto& self) {
  visit("rate_hz", self.rate_hz);
  visit("numerator", self.numerator);
  visit("denominator", self.denominator);
}
void parts(auto&& visit, Is<identification::FitQuality> auto& self) {
  visit("one_step_rms_n", self.one_step_rms_n);
  visit("one_step_vaf_percent", self.one_step_vaf_percent);
  visit("free_run_rms_n", self.free_run_rms_n);
  visit("free_run_vaf_percent", self.free_run_vaf_percent);
  visit("samples", self.samples);
}
void parts(auto&& visit, Is<identification::ArxFit> auto& self) {
  visit("model", self.model);
  visit("heldout", self.heldout);
  visit("condition_number", self.condition_number);
  visit("stable", self.stable);
}
void parts(auto&& visit, Is<identification::OutputErrorFit> auto& self) {
  visit("model", self.model);
  visit("heldout", self.heldout);
  visit("iterations", self.iterations);
  visit("converged", self.converged);
  visit("start_rms_n", self.start_rms_n);
  visit("rms_n", self.rms_n);
}
void parts(auto&& visit, Is<identification::ArxFactor> auto& self) {
  visit("order", self.order);
  visit("rate_hz", self.rate_hz);
  visit("triangle", self.triangle);
}
void parts(auto&& visit, Is<signal::TransferEstimate> auto& self) {
  visit("frequency_hz", self.frequency_hz);
  visit("response", self.response);
  visit("coherence", self.coherence);
  visit("magnitude_ci95", self.magnitude_ci95);
  visit("independent_averages", self.independent_averages);
}
void parts(auto&& visit, Is<identification::RateConversion> auto& self) {
  visit("model", self.model);
  visit("max_error", self.max_error);
  visit("excited_error", self.excited_error);
  visit("peak_gain", self.peak_gain);
  visit("reflected_poles", self.reflected_poles);
}
void parts(auto&& visit, Is<Identification> auto& self) {
  visit("paper", self.paper);
  visit("refined", self.refined);
  visit("factor", self.factor);
  visit("estimate", self.estimate);
  visit("fit", self.fit);
  visit("control", self.control);
  visit("paper_unusable", self.paper_unusable);
}
void parts(auto&& visit, Is<identification::OpenLoopLine> auto& self) {
  visit("harmonic", self.harmonic);
  visit("frequency_hz", self.frequency_hz);
  visit("gain", self.gain);
  visit("cursor_snr", self.cursor_snr);
  visit("error_snr", self.error_snr);
}
void parts(auto&& visit, Is<identification::TrackingMetrics> auto& self) {
  visit("rms_error_mm", self.rms_error_mm);
  visit("dwell_ratio", self.dwell_ratio);
  visit("crossover_hz", self.crossover_hz);
  visit("crossover_reference_hz", self.crossover_reference_hz);
  visit("lines", self.lines);
  visit("moving_rms_mm", self.moving_rms_mm);
  visit("moving_dwell", self.moving_dwell);
}
void parts(auto&& visit, Is<TrackedTrial> auto& self) {
  visit("metrics", self.metrics);
  visit("cancelled_share", self.cancelled_share);
  visit("feedthrough_rms_n", self.feedthrough_rms_n);
  visit("counterforce_delay_s", self.counterforce_delay_s);
  visit("target_m", self.target_m);
  visit("cursor_m", self.cursor_m);
}
void parts(auto&& visit, Is<SubjectResult> auto& self) {
  visit("identification", self.identification);
  visit("trials", self.trials);
  visit("order", self.order);
}

using Json = nlohmann::json;

template <typename Type>
Json to_json(const Type& value);
template <typename Type>
void from_json(const Json& json, Type& value);

template <typename Type>
inline constexpr bool kPlain = std::is_arithmetic_v<Type> || std::same_as<Type, std::string>;
template <typename Type>
concept List = requires(Type& list) {
  list[0], list.begin(), list.size();
}
&&!kPlain<Type>;

template <typename Type>
Json to_json(const Type& value) {
  if constexpr (kPlain<Type>) {
    return value;
  } else if constexpr (std::same_as<Type, Condition>) {
    return name_of(value);
  } else if constexpr (std::same_as<Type, std::complex<double>>) {
    return Json::array({value.real(), value.imag()});
  } else if constexpr (std::same_as<Type, std::map<Condition, TrackedTrial>>) {
    Json out = Json::object();
    for (const auto& [condition, each] : value) out[name_of(condition)] = to_json(each);
    return out;
  } else if constexpr (List<const Type>) {
    Json out = Json::array();
    for (const auto& each : value) out.push_back(to_json(each));
    return out;
  } else {
    Json out = Json::object();
    parts([&](const char* name, const auto& part) { out[name] = to_json(part); }, value);
    return out;
  }
}

/// @throws nlohmann::json::exception for a missing name or a value of another type.
// Called by its namespace: nlohmann has functions of this name, too.
template <typename Type>
void from_json(const Json& json, Type& value) {
  if constexpr (kPlain<Type>) {
    value = json.get<Type>();
  } else if constexpr (std::same_as<Type, Condition>) {
    value = named(json.get<std::string>());
  } else if constexpr (std::same_as<Type, std::complex<double>>) {
    value = {json.at(0).get<double>(), json.at(1).get<double>()};
  } else if constexpr (std::same_as<Type, std::map<Condition, TrackedTrial>>) {
    for (const auto& [name, each] : json.items()) stored::from_json(each, value[named(name)]);
  } else if constexpr (List<Type>) {
    if constexpr (requires { value.resize(1); }) value.resize(json.size());
    for (std::size_t i = 0; i < value.size(); ++i) stored::from_json(json.at(i), value[i]);
  } else {
    parts([&](const char* name, auto& part) { stored::from_json(json.at(name), part); }, value);
  }
}

}  // namespace stillhand::study::stored
