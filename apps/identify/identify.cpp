// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/identify.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/identify/worthless.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/identification/excitation_check.hpp"
#include "services/core/identification/paper_preprocessing.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::identify {
namespace {

using diagnosis::Channel;
using diagnosis::Measurement;
using diagnosis::Stretch;

std::string count(std::size_t samples) { return fmt::format("{} samples", samples); }

// Frequencies of the model's response: from a seventh of the excited band's lower edge to twice the
// preprocessing filter's.
constexpr double kLowestHz = 0.1;
constexpr double kHighestHz = 20.0;
constexpr int kResponsePoints = 120;
// Two neighbours of the search for a notch are 0.2 % apart.
constexpr int kNotchPoints = 2000;
constexpr double kNotchLowestHz = 0.5;
constexpr double kNotchHighestHz = 10.0;  // the preprocessing filter's edge
// A smaller rise can be a ripple from the random error of the fit.
constexpr double kNotchDepth_db = 1.0;
// 5 s at 50 Hz: lines of 0.2 Hz resolve the excited band's lower edge.
constexpr std::size_t kSegmentSamples = 256;

const Channel& channel_of(const Measurement& measurement, const std::string& option,
                          const std::string& name) {
  const Channel* channel = measurement.find(name);
  if (channel != nullptr) return *channel;
  std::string names;
  for (const Channel& each : measurement.channels) names += (names.empty() ? "" : ", ") + each.name;
  throw ConfigError(option, "'" + name + "'",
                    fmt::format("one of {} in {}", names, measurement.source));
}

const Stretch& longest(const std::vector<Stretch>& stretches) {
  return *std::ranges::max_element(stretches, {}, [](const Stretch& s) { return s.end - s.first; });
}

std::vector<double> cut(const Channel& channel, const Stretch& stretch) {
  const auto begin = channel.values.begin();
  return {begin + static_cast<std::ptrdiff_t>(stretch.first),
          begin + static_cast<std::ptrdiff_t>(stretch.end)};
}

// The divisor of the input before the fit.
double scale_of(const Channel& input, const std::vector<double>& values) {
  if (input.unit == "m/s^2") return 1.0;
  const double rms = std::sqrt(signal::variance(values));
  return std::isnormal(rms) && std::isnormal(1.0 / rms) ? rms : 1.0;
}

void divide(std::vector<double>& values, double scale) {
  for (double& value : values) value /= scale;
}

identification::Record record_of(const Measurement& measurement, const Channel& input,
                                 const Channel& output, const Stretch& stretch) {
  if (measurement.rate_hz < identification::kLeastRecordingRateHz) {
    throw ConfigError(measurement.source, fmt::format("{:.6g} Hz", measurement.rate_hz),
                      "100 Hz or more, the paper's recording rate");
  }
  const std::size_t samples = stretch.end - stretch.first;
  if (static_cast<double>(samples) < measurement.rate_hz) {
    throw ConfigError(measurement.source, "no more than " + count(samples) + " without a long gap",
                      "a second or more");
  }
  return {measurement.rate_hz, cut(input, stretch), cut(output, stretch)};
}

// Checked before the filters, whose transient would turn a constant into a step.
void check_moves(const Channel& channel, const std::vector<double>& values,
                 const std::string& source) {
  const auto [low, high] = std::ranges::minmax(values);
  if (low < high) return;
  throw ConfigError(source + ", channel " + channel.name,
                    fmt::format("{:g} {} throughout", low, channel.unit), "a channel that varies");
}

// Adds the file and the channels, which the chain's own messages do not name.
void check_excitation(const identification::Record& fitted, const IdentifyOptions& options,
                      const std::string& source) {
  const auto excitation =
      identification::check_excitation(fitted, static_cast<int>(options.config.order));
  if (!excitation.sufficient) {
    throw ConfigError(source + ", " + options.input + " to " + options.output, excitation.verdict,
                      "a recording that excites the system to be identified");
  }
}

std::optional<Notch> notch_of(const signal::DifferenceModel& model) {
  const auto points = identification::frequency_response(
      model, identification::log_spaced_hz(kNotchLowestHz, kNotchHighestHz, kNotchPoints));
  const auto lower = [](const auto& a, const auto& b) { return a.magnitude_db < b.magnitude_db; };
  for (auto at = points.begin() + 1; at + 1 < points.end(); ++at) {
    if (!lower(*at, *(at - 1)) || lower(*(at + 1), *at)) continue;
    const double wall = at->magnitude_db + kNotchDepth_db;
    const double before = std::max_element(points.begin(), at, lower)->magnitude_db;
    const double after = std::max_element(at, points.end(), lower)->magnitude_db;
    if (before >= wall && after >= wall) return Notch{at->frequency_hz, at->magnitude_db};
  }
  return {};
}

// Runs the chain.  Keeps the fit if no filter for the canceller results.
void fit(const identification::Record& recorded, const identification::Record& fitted,
         const identification::Config& config, IdentifyResult& out) {
  const auto paper = identification::fit_arx(fitted, static_cast<int>(config.order));
  out.model.condition_number = paper.condition_number;
  try {
    const auto steps = identification::identify_stepwise(recorded, config, false);
    out.model.control = steps.control.model;
    out.model.conversion_error = steps.control.max_error;
    out.model.refined = steps.refined_used;
    out.why_refined = steps.refined_used && config.refine  ? "as requested"
                      : steps.paper_unusable == "unstable" ? "the paper's fit is unstable"
                                                           : steps.paper_unusable;
  } catch (const ConfigError& error) {
    out.unusable = error.what();
    out.reason = "filter";
    out.model.refined = config.refine || !paper.stable;
    if (out.model.refined)
      out.why_refined = config.refine ? "as requested" : "the paper's fit is unstable";
  }
  if (out.model.refined) {
    const auto refined = identification::refine_output_error(fitted, paper.model);
    out.model.fit = refined.model;
    out.model.heldout = refined.heldout;
  } else {
    out.model.fit = paper.model;
    out.model.heldout = paper.heldout;
  }
}

// The model, Eq. ID-1, has no constant term.
void note_offset(const Channel& channel, const std::vector<double>& values,
                 std::vector<std::string>& notes) {
  const double mean = signal::mean(values);
  if (std::abs(mean) <= std::sqrt(signal::variance(values))) return;
  notes.push_back(
      fmt::format("{} has a mean of {:.4g} {}, larger than its variation; the paper's model has no "
                  "offset, so the mean distorts the fit.",
                  channel.name, mean, channel.unit));
}

void note_what_was_used(const Measurement& measurement, const Stretch& used,
                        std::vector<std::string>& notes) {
  if (measurement.stretches.size() > 1) {
    notes.push_back(fmt::format("The longest of {} stretches is used, {} of {}.",
                                measurement.stretches.size(), count(used.end - used.first),
                                count(measurement.size())));
  }
}

}  // namespace

IdentifyResult identify(const Measurement& measurement, const IdentifyOptions& options) {
  const Channel& input = channel_of(measurement, "--input", options.input);
  const Channel& output = channel_of(measurement, "--output", options.output);
  if (&input == &output) {
    throw ConfigError("--output", "'" + output.name + "', which is the input",
                      "a channel other than --input");
  }
  const Stretch& used = longest(measurement.stretches);
  identification::Record recorded = record_of(measurement, input, output, used);
  check_moves(input, recorded.acceleration_m_s2, measurement.source);
  check_moves(output, recorded.force_n, measurement.source);
  const bool same = recorded.force_n == recorded.acceleration_m_s2;
  IdentifyResult out;
  out.source = measurement.source;
  out.input = input.name;
  out.input_unit = input.unit;
  out.excited =
      diagnosis::excited_band(input.name, recorded.acceleration_m_s2,
                              signal::mean(recorded.acceleration_m_s2), measurement.rate_hz);
  out.output = output.name;
  out.output_unit = output.unit;
  out.rate_hz = measurement.rate_hz;
  out.samples = recorded.size();
  out.notes = measurement.notes;
  out.screening = measurement.screening;
  note_what_was_used(measurement, used, out.notes);
  note_offset(input, recorded.acceleration_m_s2, out.notes);
  note_offset(output, recorded.force_n, out.notes);
  const double scale = scale_of(input, recorded.acceleration_m_s2);
  divide(recorded.acceleration_m_s2, scale);
  identification::Record fitted = identification::preprocessed(recorded);
  check_excitation(fitted, options, measurement.source);
  if (same) {
    throw ConfigError(measurement.source,
                      "'" + output.name + "' with the values of '" + input.name + "'",
                      "a measured response to the input");
  }
  fit(recorded, fitted, options.config, out);
  if (auto none = why_worthless(measurement, options, fitted, out)) {
    out.unusable = std::move(none->why);
    out.reason = std::move(none->reason);
  }
  divide(out.model.fit.numerator, scale);
  divide(out.model.control.numerator, scale);
  for (double& value : fitted.acceleration_m_s2) value *= scale;
  out.response = identification::frequency_response(
      out.model.fit, identification::log_spaced_hz(kLowestHz, kHighestHz, kResponsePoints));
  out.dc_gain_db = identification::frequency_response(out.model.fit, {0.0}).front().magnitude_db;
  out.notch = notch_of(out.model.fit);
  const std::size_t segment = std::min(kSegmentSamples, fitted.size() / 8 * 2);
  out.measured = signal::transfer_estimate(
      signal::cross_spectra(fitted.acceleration_m_s2, fitted.force_n, fitted.rate_hz, segment));
  return out;
}

}  // namespace stillhand::identify
