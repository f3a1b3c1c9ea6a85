// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/worthless.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/identify/changed_output.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/before_effects.hpp"
#include "services/core/diagnosis/detection/detection.hpp"
#include "services/core/diagnosis/limit.hpp"
#include "services/core/diagnosis/share_words.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::identify {
namespace {

using diagnosis::Measurement;
using diagnosis::NoModel;

// [-] of the squared error that another reading of the recording must leave at most.
constexpr double kBetterReading = 0.5;

double vaf_after(const diagnosis::Alignment& by, const identification::Record& fitted,
                 const IdentifyOptions& options, bool refined = false) {
  identification::Record moved = fitted;
  moved.acceleration_m_s2 = diagnosis::moved(fitted.acceleration_m_s2, fitted.rate_hz, by);
  const auto arx = identification::fit_arx(moved, static_cast<int>(options.config.order));
  return refined
             ? identification::refine_output_error(moved, arx.model).heldout.free_run_vaf_percent
             : arx.heldout.free_run_vaf_percent;
}

// What the paper's fit of the input to the output leaves; all, where there is none or none that is
// stable.
double left_exchanged(const identification::Record& fitted, const IdentifyOptions& options) {
  try {
    const auto other =
        identification::fit_arx({fitted.rate_hz, fitted.force_n, fitted.acceleration_m_s2},
                                static_cast<int>(options.config.order));
    return other.stable ? 1.0 - 0.01 * other.heldout.free_run_vaf_percent : 1.0;
  } catch (const ConfigError&) {
    return 1.0;  // the output alone excites nothing
  }
}

// Eq. DG-81; empty: the future of the input explains no more.
std::string why_future(const IdentifyOptions& options, const identification::Record& fitted,
                       double left, bool refined) {
  if (left < diagnosis::kLeadGate) return {};
  for (const double lead_s : diagnosis::kLeads_s) {
    const double vaf = vaf_after({-lead_s, 0.0, 0.0}, fitted, options, refined);
    if (!(1.0 - 0.01 * vaf < diagnosis::kBetterLead * left)) continue;
    const double back = left_exchanged(fitted, options);
    return back < kBetterReading * left
               ? diagnosis::swapped_in_words(options.input, 1.0 - back, options.output, 1.0 - left)
               : diagnosis::lead_in_words(options.input, options.output, lead_s, 1.0 - 0.01 * vaf,
                                          left);
  }
  return {};
}

// A limit of the output, which a linear model takes for a smaller gain; empty: it is hardly
// reached.
std::string why_clipped(const Measurement& measurement, const IdentifyOptions& options) {
  for (const diagnosis::SampleFault& fault : measurement.screening) {
    if (fault.what != "clipped" || fault.share <= diagnosis::kMostClipped ||
        fault.channel != options.output) {
      continue;
    }
    return fmt::format(
        "{} is clipped in {:.3g} % of the rows, and the model's gain is wrong by "
        "about that; diagnose has effects for a limit",
        fault.channel, 100.0 * fault.share);
  }
  return {};
}

// What the paper's fit to a record leaves of all of it; all, where there is none.
double left_of_all(const identification::Record& record, const IdentifyOptions& options) {
  try {
    const auto fit = identification::fit_arx(record, static_cast<int>(options.config.order));
    return 1.0 - 0.01 * identification::vaf_percent(
                            record.force_n, signal::simulated(fit.model, record.acceleration_m_s2));
  } catch (const ConfigError&) {
    return 1.0;
  }
}

// A part in which the input has another level, or the output another level or gain: a linear model
// takes them for a body in between.  Empty: a model without that leaves as much.
std::string why_stepped(const IdentifyOptions& options, const identification::Record& fitted,
                        const std::vector<double>& predicted, double left,
                        const IdentifyResult& result) {
  for (const bool of_input : {false, true}) {
    identification::Record mended = fitted;
    std::vector<double>& y = of_input ? mended.acceleration_m_s2 : mended.force_n;
    const Change found = change_of(y, of_input ? fitted.force_n : predicted);
    // The force is no model of its input, but shows a level that it does not answer.
    if (of_input ? !found.of_level : found.error_ratio >= kBetterReading) continue;
    for (std::size_t i = found.first; i < found.end; ++i) {
      y[i] = found.of_level ? y[i] - found.level : y[i] / found.gain;
    }
    const double least = left_of_all(mended, options);
    const double enough = of_input ? diagnosis::kBetterClock : kBetterReading;
    if (!(least < enough * std::min(left, 1.0))) continue;
    const std::string what =
        found.of_level
            ? fmt::format("the mean of {} is {:.3g} {} higher",
                          of_input ? options.input : options.output,
                          of_input ? found.level / std::sqrt(signal::variance(y)) : found.level,
                          of_input ? "times its RMS" : result.output_unit)
            : fmt::format("{} has {:.3g} times the gain", options.output, found.gain);
    return fmt::format(
        "{} from {:.4g} to {:.4g} s of {:.4g} s, by a step or slowly: without that a model leaves "
        "{:.3g} % of {}, this one {:.3g} %{}",
        what, static_cast<double>(found.first) / fitted.rate_hz,
        static_cast<double>(found.end) / fitted.rate_hz,
        static_cast<double>(y.size()) / fitted.rate_hz, 100.0 * least, options.output, 100.0 * left,
        of_input ? "" : "; diagnose has effects for it");
  }
  return {};
}

// A limit with noise on top, whose rows are not equal.
std::string why_limited(const IdentifyOptions& options, const identification::Record& fitted,
                        const std::vector<double>& predicted, const std::string& unit) {
  const diagnosis::Limit limit = diagnosis::limit_of(fitted.force_n, predicted);
  if (limit.share <= diagnosis::kMostClipped || limit.error_ratio >= kBetterReading) return {};
  std::string ends;
  for (const double end : {limit.low, limit.high}) {
    if (std::isfinite(end)) ends += fmt::format("{}{:.3g}", ends.empty() ? "" : " and ", end);
  }
  return fmt::format(
      "{} follows {} up to {} {}, and stays there in {:.3g} % of the rows: a limit or a friction, "
      "and "
      "the model's gain is wrong by about that; diagnose has effects for both",
      options.output, options.input, ends, unit, 100.0 * limit.share);
}

// Levels, gains and limits that change what the whole record shows, and that the last quarter alone
// need not show.  Empty: none.
std::string why_changed(const IdentifyOptions& options, const identification::Record& fitted,
                        const IdentifyResult& result) {
  const auto predicted = signal::simulated(result.model.fit, fitted.acceleration_m_s2);
  const double left = 1.0 - 0.01 * identification::vaf_percent(fitted.force_n, predicted);
  // A gain that is wrong by a share leaves the square of it.
  if (left < diagnosis::kMostClipped * diagnosis::kMostClipped) return {};
  if (std::string why = why_stepped(options, fitted, predicted, left, result); !why.empty()) {
    return why;
  }
  std::string why = why_limited(options, fitted, predicted, result.output_unit);
  const double vaf = result.model.heldout.free_run_vaf_percent;
  if (!why.empty() || left < 0.5 || vaf < 50.0) return why;
  return fmt::format(
      "{} explains {:.3g} % of {} in the last quarter, and {:.3g} % of the whole recording: a part "
      "of it is another motion or another force",
      options.input, vaf, options.output, 100.0 - 100.0 * left);
}

// The response of a motion to the force that it causes differentiates: least squares find no stable
// one, and far more the other way round.  Empty: not so.
std::string why_exchanged(const IdentifyOptions& options, const identification::Record& fitted,
                          double left) {
  const auto order = static_cast<int>(options.config.order);
  if (left < diagnosis::kLeadGate || identification::fit_arx(fitted, order).stable) return {};
  const double back = left_exchanged(fitted, options);
  if (!(back < diagnosis::kBetterLead * left)) return {};
  return diagnosis::swapped_in_words(options.input, 1.0 - back, options.output, 1.0 - left);
}

}  // namespace

std::optional<NoModel> why_worthless(const Measurement& measurement, const IdentifyOptions& options,
                                     const identification::Record& fitted,
                                     const IdentifyResult& result) {
  if (auto none = diagnosis::before_any_fit(measurement, {options.input}, options.output)) {
    return none;
  }
  if (std::string why = why_clipped(measurement, options); !why.empty()) {
    return NoModel{"effects", std::move(why)};
  }
  const double left = 1.0 - 0.01 * result.model.heldout.free_run_vaf_percent;
  std::string mass = diagnosis::unlikely_mass(
      {options.input, result.input_unit, std::sqrt(signal::variance(fitted.acceleration_m_s2)),
       options.output, result.output_unit,
       std::sqrt(std::max(0.0, 1.0 - left)) * std::sqrt(signal::variance(fitted.force_n)),
       options.heaviest_kg});
  if (left < 0.5 && !mass.empty()) return NoModel{"unit", std::move(mass)};
  if (std::string why = why_changed(options, fitted, result); !why.empty()) {
    return NoModel{"effects", std::move(why)};
  }
  if (left > diagnosis::kMostClipped * diagnosis::kMostClipped) {
    std::string why = diagnosis::limit_in_words(options.input, fitted.acceleration_m_s2,
                                                options.output, fitted.force_n, fitted.rate_hz);
    if (!why.empty()) return NoModel{"samples", std::move(why)};
  }
  if (std::string why = why_exchanged(options, fitted, left); !why.empty()) {
    return NoModel{"swapped", std::move(why)};
  }
  if (std::string why = why_future(options, fitted, left, result.model.refined); !why.empty()) {
    return NoModel{"swapped", std::move(why)};
  }
  if (left <= diagnosis::kAlignmentGate) return {};
  const diagnosis::Alignment alignment =
      diagnosis::aligned(fitted.acceleration_m_s2, fitted.force_n, fitted.rate_hz);
  double most = result.model.heldout.free_run_vaf_percent;
  diagnosis::Alignment best;
  for (const diagnosis::Alignment& each : diagnosis::readings(alignment)) {
    const double vaf = vaf_after(each, fitted, options);
    if (vaf <= most) continue;
    most = vaf;
    best = each;
  }
  if (1.0 - 0.01 * most < diagnosis::kBetterClock * left) {
    return NoModel{
        "clocks",
        fmt::format("{}: a model after that explains {} instead of {}", diagnosis::in_words(best),
                    diagnosis::share_in_words(0.01 * most), diagnosis::share_in_words(1.0 - left))};
  }
  if (left <= 1.0 - diagnosis::kLeastShare) return {};
  return NoModel{
      "unrelated",
      fmt::format("{} explains {} of {} on samples that the fit has not seen, {:g} % or more would "
                  "be something: these channels don't belong together, or no linear model joins "
                  "them",
                  options.input, diagnosis::share_in_words(1.0 - left), options.output,
                  100.0 * diagnosis::kLeastShare)};
}

}  // namespace stillhand::identify
