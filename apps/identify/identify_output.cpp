// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/identify_output.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "apps/libraries/measurement/screening_json.hpp"
#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/share_words.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::identify {
namespace {

using nlohmann::ordered_json;

ordered_json model_json(const signal::DifferenceModel& model) {
  return {{"numerator", model.numerator},
          {"denominator", model.denominator},
          {"rate_hz", model.rate_hz}};
}

ordered_json response_json(const IdentifyResult& result) {
  ordered_json points = ordered_json::array();
  for (const auto& point : result.response) {
    points.push_back({{"frequency_hz", point.frequency_hz},
                      {"magnitude_db", point.magnitude_db},
                      {"phase_deg", point.phase_deg}});
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
                      {"magnitude_db", 20.0 * std::log10(std::abs(h))},
                      {"phase_deg", std::arg(h) * 180.0 / std::numbers::pi},
                      {"coherence", measured.coherence[k]},
                      {"magnitude_ci95", measured.magnitude_ci95[k]}});
  }
  return points;
}

std::string coefficient_table(const IdentifyResult& result) {
  const std::string title = fmt::format("c_i [{}/({})]", result.output_unit, result.input_unit);
  std::string text = fmt::format("  {:>2}  {:>18}  {:>18}\n", "i", title, "d_i [-]");
  for (std::size_t i = 0; i < result.model.fit.denominator.size(); ++i) {
    text += fmt::format("  {:2}  {:18.9g}  {:18.9g}\n", i, result.model.fit.numerator[i],
                        result.model.fit.denominator[i]);
  }
  return text;
}

// What no single recording shows: an axis that is turned, or a unit between two that a hand has,
// gives as good a model.
std::string assumed_of(const IdentifyResult& result) {
  const auto sum = [](const std::vector<double>& x) { return std::reduce(x.begin(), x.end()); };
  const bool same = sum(result.model.fit.numerator) * sum(result.model.fit.denominator) > 0.0;
  const std::string unchecked = diagnosis::why_unchecked(
      {result.input, result.input_unit, 0.0, result.output, result.output_unit, 0.0});
  return fmt::format(
      "signs and units as the columns state them ({} has {} at 0 Hz); one recording does not show "
      "whether they are right{}",
      result.output, same ? "the sign of " + result.input : "the sign opposite to " + result.input,
      unchecked.empty() ? "" : "; " + unchecked);
}

// What the recording does not show at a frequency.
std::string beyond(const IdentifyResult& result, double frequency_hz) {
  const bool inside =
      frequency_hz >= result.excited.low_hz && frequency_hz <= result.excited.high_hz;
  return inside ? "" : ", extrapolated by the model: the input has no power there";
}

std::string quality_lines(const IdentifyResult& result) {
  const auto& heldout = result.model.heldout;
  std::string text =
      fmt::format("stable             {}\n", signal::is_stable(result.model.fit) ? "yes" : "no");
  text += fmt::format(
      "free run, unseen   {}, RMS error {:.4g} {} (last quarter, {:.3g} s, fit to the rest, from "
      "the "
      "input alone; VAF: share of the variance explained)\n",
      diagnosis::vaf_in_words(heldout.free_run_vaf_percent), heldout.free_run_rms_n,
      result.output_unit, static_cast<double>(heldout.samples) / result.model.fit.rate_hz);
  // The next sample alone is known well enough from the last one.
  if (result.unusable.empty()) {
    text += fmt::format("one step, unseen   {}\n",
                        diagnosis::vaf_in_words(heldout.one_step_vaf_percent));
  }
  text += fmt::format("condition number   {:.3g}\n", result.model.condition_number);
  text += fmt::format("excited band       {:.3g} to {:.3g} Hz, 98 % of the power of {}\n",
                      result.excited.low_hz, result.excited.high_hz, result.input);
  text += fmt::format("gain at 0 Hz       {:.2f} dB{}\n", result.dc_gain_db, beyond(result, 0.0));
  text += result.notch ? fmt::format("notch              {:.2f} Hz, {:.1f} dB{}\n",
                                     result.notch->frequency_hz, result.notch->magnitude_db,
                                     beyond(result, result.notch->frequency_hz))
                       : "notch              none from 0.5 to 10 Hz\n";
  text += "assumed            " + assumed_of(result) + "\n";
  if (result.unusable.empty()) {
    text += fmt::format("filter at 1 kHz    within {:.2f} % of the model's peak gain, 0 to 10 Hz\n",
                        100.0 * result.model.conversion_error);
  }
  return text;
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
       {{"free_run_vaf_percent", heldout.free_run_vaf_percent},
        {"free_run_rmse", heldout.free_run_rms_n},
        {"one_step_vaf_percent", heldout.one_step_vaf_percent},
        {"samples", heldout.samples}}},
      {"stable", signal::is_stable(result.model.fit)},
      {"refined", result.model.refined},
      {"why_refined", result.why_refined},
      {"condition_number", result.model.condition_number},
      {"dc_gain_db", result.dc_gain_db},
      {"excited_band_hz", {result.excited.low_hz, result.excited.high_hz}},
      {"notch_hz", result.notch ? ordered_json(result.notch->frequency_hz) : nullptr},
      {"usable", usable},
      {"why", result.unusable},
      {"reason", result.reason},
      {"text", result.unusable},
      {"assumed", assumed_of(result)},
      {"screening", measurement::screening_json(result.screening)},
      {"control_model", usable ? model_json(result.model.control) : ordered_json(nullptr)},
      {"conversion_error", usable ? ordered_json(result.model.conversion_error) : nullptr},
      {"notes", result.notes}};
  json["frequency_response"] = response_json(result);
  json["measured_response"] = measured_json(result);
  // A file's name may contain bytes that are no UTF-8.  JSON has no infinity: dump() writes a
  // number that is not finite, such as the logarithm of an exact zero, as null.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string result_table(const IdentifyResult& result) {
  std::string text =
      result.unusable.empty() ? "" : "usable             no: " + result.unusable + "\n";
  text += "recording          " + result.source + "\n";
  for (const std::string& note : result.notes) text += "                   " + note + "\n";
  text += fmt::format("input, output      {} [{}], {} [{}]\n", result.input, result.input_unit,
                      result.output, result.output_unit);
  text +=
      fmt::format("rate, samples      {:.6g} Hz, {} ({:.4g} s); fitted at {:.6g} Hz\n",
                  result.rate_hz, result.samples,
                  static_cast<double>(result.samples) / result.rate_hz, result.model.fit.rate_hz);
  text += fmt::format(
      "model              order {}, {}\n", result.model.fit.order(),
      result.model.refined ? "refined on its free-run error" : "the paper's least squares");
  if (result.model.refined) {
    text += fmt::format("                   ({})\n", result.why_refined);
  }
  return text + coefficient_table(result) + quality_lines(result);
}

}  // namespace stillhand::identify
