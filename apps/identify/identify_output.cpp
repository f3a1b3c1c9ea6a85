// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/identify_output.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "services/signal/difference_model.hpp"

namespace stillhand::identify {
namespace {

using nlohmann::ordered_json;

// JSON has no infinity: the logarithm of an exact zero becomes null.
ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json model_json(const signal::DifferenceModel& model) {
  return {{"numerator", model.numerator},
          {"denominator", model.denominator},
          {"rate_hz", model.rate_hz}};
}

ordered_json response_json(const IdentifyResult& result) {
  ordered_json points = ordered_json::array();
  for (const auto& point : result.response) {
    points.push_back({{"frequency_hz", point.frequency_hz},
                      {"magnitude_db", number(point.magnitude_db)},
                      {"phase_deg", number(point.phase_deg)}});
  }
  return points;
}

ordered_json measured_json(const IdentifyResult& result) {
  ordered_json points = ordered_json::array();
  const auto& measured = result.measured;
  // Leaves out the first line, 0 Hz, whose mean was removed, and the last, half the rate.
  for (std::size_t k = 1; k + 1 < measured.frequency_hz.size(); ++k) {
    const auto h = measured.response[k];
    points.push_back({{"frequency_hz", measured.frequency_hz[k]},
                      {"magnitude_db", number(20.0 * std::log10(std::abs(h)))},
                      {"phase_deg", number(std::arg(h) * 180.0 / std::numbers::pi)},
                      {"coherence", number(measured.coherence[k])},
                      {"magnitude_ci95", number(measured.magnitude_ci95[k])}});
  }
  return points;
}

// printf onto the end of a text.
[[gnu::format(printf, 2, 3)]] void print(std::string& text, const char* format, ...) {
  char line[400];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof(line), format, arguments);
  va_end(arguments);
  text += line;
}

void print_coefficients(std::string& text, const IdentifyResult& result) {
  const std::string unit = result.output_unit + "/(" + result.input_unit + ")";
  print(text, "  %2s  %18s  %18s\n", "i", ("c_i [" + unit + "]").c_str(), "d_i [-]");
  for (std::size_t i = 0; i < result.model.fit.denominator.size(); ++i) {
    print(text, "  %2zu  %18.9g  %18.9g\n", i, result.model.fit.numerator[i],
          result.model.fit.denominator[i]);
  }
}

void print_quality(std::string& text, const IdentifyResult& result) {
  const auto& heldout = result.model.heldout;
  print(text, "stable             %s\n", signal::is_stable(result.model.fit) ? "yes" : "no");
  print(text, "free run, unseen   VAF %.2f %%, RMS error %.4g %s (last quarter, fit to the rest)\n",
        heldout.free_run_vaf_percent, heldout.free_run_rms_n, result.output_unit.c_str());
  print(text, "one step, unseen   VAF %.2f %%\n", heldout.one_step_vaf_percent);
  print(text, "condition number   %.3g\n", result.model.condition_number);
  print(text, "gain at 0 Hz       %.2f dB\n", result.dc_gain_db);
  if (result.notch) {
    print(text, "notch              %.2f Hz, %.1f dB\n", result.notch->frequency_hz,
          result.notch->magnitude_db);
  } else {
    print(text, "notch              none from 0.5 to 10 Hz\n");
  }
  if (result.unusable.empty()) {
    print(text, "filter at 1 kHz    within %.2f %% of the model's peak gain, 0 to 10 Hz\n",
          100.0 * result.model.conversion_error);
  } else {
    text += "filter at 1 kHz    none (" + result.unusable + ")\n";
  }
}

}  // namespace

std::string result_json(const IdentifyResult& result) {
  const auto& heldout = result.model.heldout;
  const bool usable = result.unusable.empty();
  ordered_json json{
      {"input", result.input},
      {"output", result.output},
      {"input_unit", result.input_unit},
      {"output_unit", result.output_unit},
      {"recording", result.source},
      {"sample_rate_hz", result.rate_hz},
      {"samples", result.samples},
      {"order", result.model.fit.order()},
      {"model", model_json(result.model.fit)},
      {"heldout",
       {{"free_run_vaf_percent", number(heldout.free_run_vaf_percent)},
        {"free_run_rmse", number(heldout.free_run_rms_n)},
        {"one_step_vaf_percent", number(heldout.one_step_vaf_percent)},
        {"samples", heldout.samples}}},
      {"stable", signal::is_stable(result.model.fit)},
      {"refined", result.model.refined},
      {"why_refined", result.why_refined},
      {"condition_number", number(result.model.condition_number)},
      {"dc_gain_db", number(result.dc_gain_db)},
      {"notch_hz", result.notch ? ordered_json(result.notch->frequency_hz) : nullptr},
      {"usable", usable},
      {"text", result.unusable},
      {"control_model", usable ? model_json(result.model.control) : ordered_json(nullptr)},
      {"conversion_error", usable ? number(result.model.conversion_error) : nullptr},
      {"notes", result.notes}};
  json["frequency_response"] = response_json(result);
  json["measured_response"] = measured_json(result);
  // A file's name may contain bytes that are no UTF-8.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string result_table(const IdentifyResult& result) {
  std::string text = "recording          " + result.source + "\n";
  for (const std::string& note : result.notes) text += "                   " + note + "\n";
  text += "input, output      " + result.input + " [" + result.input_unit + "], " + result.output +
          " [" + result.output_unit + "]\n";
  print(text, "rate, samples      %.6g Hz, %zu (%.4g s); fitted at %.6g Hz\n", result.rate_hz,
        result.samples, static_cast<double>(result.samples) / result.rate_hz,
        result.model.fit.rate_hz);
  print(text, "model              order %zu, %s\n", result.model.fit.order(),
        result.model.refined ? "refined on its free-run error" : "the paper's least squares");
  if (result.model.refined) {
    text += "                   (" + result.why_refined + ")\n";
  }
  print_coefficients(text, result);
  print_quality(text, result);
  return text;
}

}  // namespace stillhand::identify
