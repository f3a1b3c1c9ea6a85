// SPDX-License-Identifier: Apache-2.0
#include "apps/predict/predict.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/record/digits.hpp"
#include "services/core/diagnosis/start_state.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::predict {
namespace {

using diagnosis::Measurement;

// Cubic through the four nearest (Catmull and Rom); the ends are held.  decimated() leaves out a
// stretch that is shorter than one sample of the model: NaN there.
std::vector<double> spread_out(const std::vector<double>& x, const Measurement& from,
                               const Measurement& to, std::size_t factor) {
  if (factor <= 1) return x;
  std::vector<double> y;
  auto stretch = from.stretches.begin();
  for (const diagnosis::Stretch& fine : to.stretches) {
    const std::size_t length = fine.end - fine.first;
    if (length < factor) {
      y.insert(y.end(), length, std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const auto first = static_cast<std::ptrdiff_t>(stretch->first);
    const auto last = static_cast<std::ptrdiff_t>(stretch->end) - 1;
    ++stretch;
    const auto at = [&](std::ptrdiff_t n) {
      return x[static_cast<std::size_t>(std::clamp(n, first, last))];
    };
    for (std::size_t n = 0; n < length; ++n) {
      const auto k = first + static_cast<std::ptrdiff_t>(n / factor);
      const double t = static_cast<double>(n % factor) / static_cast<double>(factor);
      const double slope0 = 0.5 * (at(k + 1) - at(k - 1));
      const double slope1 = 0.5 * (at(k + 2) - at(k));
      const double rise = at(k + 1) - at(k);
      y.push_back(at(k) + t * (slope0 + t * (3.0 * rise - 2.0 * slope0 - slope1 +
                                             t * (slope0 + slope1 - 2.0 * rise))));
    }
  }
  return y;
}

std::string digits_of(double value) { return diagnosis::digits(value, 3); }

// Where the recording leaves a range in which the model was seen, Eq. DG-56.
void add_ranges(const std::vector<diagnosis::LeftRange>& left, Prediction& prediction) {
  for (const diagnosis::LeftRange& each : left) {
    const diagnosis::SeenRange& range = each.range;
    const std::string what = range.of == "argument" ? "what it acts on" : range.of;
    const std::string unit = range.unit.empty() ? "" : " " + range.unit;
    std::string note = each.effect.empty() ? what : each.effect + ": " + what;
    note += " leaves the range that was seen, ";
    // What acts inside a body has a scale of its own.
    if (!unit.empty()) note += digits_of(range.low) + " to " + digits_of(range.high) + unit + ", ";
    note += "in " + digits_of(100.0 * each.share) + " % of the samples; ";
    if (each.effect.empty()) {
      note += "the linear part continues";
    } else if (unit.empty()) {
      note += "far outside of it the effect keeps its value";
    } else {
      note += "the effect keeps its value below " + digits_of(range.lower_edge());
      note += " and above " + digits_of(range.upper_edge()) + unit;
    }
    prediction.notes.push_back(std::move(note));
  }
}

// Where the recording moves an input at frequencies at which the fitted one did not, Eq. DG-65.
void add_bands(const std::vector<diagnosis::ExcitedBand>& bands, const diagnosis::Signals& signals,
               Prediction& prediction) {
  constexpr double kWorthANote = 0.05;  // of the power; 0.02 of the fitted recording's
  for (const diagnosis::ExcitedBand& band : bands) {
    const diagnosis::Signal& input = signals.at(band.of);
    const double share =
        diagnosis::power_outside(band, input.values, input.mean, signals.rate_hz());
    if (share < kWorthANote) continue;
    prediction.notes.push_back(
        digits_of(100.0 * share) + " % of the power of " + band.of + " lies outside " +
        digits_of(band.low_hz) + " to " + digits_of(band.high_hz) +
        " Hz, the band of the fitted recording, on which alone the model was fitted");
  }
}

void add_notes(const diagnosis::CarriedModel& carried, Prediction& prediction) {
  for (const diagnosis::LeftOut& each : carried.left_out) {
    prediction.notes.push_back(each.effect.kind + ": left out, because " + each.why);
  }
  for (const diagnosis::Effect& effect : carried.model.effects) {
    if (effect.is_whole()) continue;
    prediction.notes.push_back(
        effect.kind + ": taken at " + digits_of(100.0 * effect.share) +
        " % of its size, the share on which the parts of its recording agree");
  }
  if (carried.stability == diagnosis::Stability::kTested) {
    prediction.notes.emplace_back(
        "the model's stability is tested, not proved: on the inputs of the fitted recording and on "
        "others with their spectrum");
  }
  for (const diagnosis::Effect& effect : carried.model.effects) {
    const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
    if (!kind.time_only(effect)) continue;
    const bool gain = kind.stage(effect) == diagnosis::Stage::kGain;
    prediction.notes.push_back(effect.kind +
                               (gain ? ": the gain is taken at its mean, because it depends on time"
                                     : ": left out, because the inputs do not determine it"));
  }
}

struct Prepared {
  const diagnosis::Model& model;
  Measurement whole;    // with the output, even if it is not known
  std::size_t factor;   // rows a sample of the model
  Measurement working;  // at the model's rate
};

// Each input, in the unit in which the model was fitted.
void check_inputs(const diagnosis::CarriedModel& carried, const Measurement& measurement) {
  for (const std::string& name : carried.model.inputs) {
    const diagnosis::Channel* channel = measurement.find(name);
    if (channel == nullptr) continue;  // named where the signals are made
    const auto range = std::ranges::find(carried.inputs, name, &diagnosis::SeenRange::of);
    if (range == carried.inputs.end() || range->unit.empty() || range->unit == channel->unit) {
      continue;
    }
    throw ConfigError(measurement.source + ": input '" + name + "'",
                      "values in [" + channel->unit + "]",
                      "[" + range->unit + "], in which the model was fitted");
  }
}

// Each channel of an effect, or what it is made of.
void check_effects(const diagnosis::Model& model, const Measurement& measurement,
                   const diagnosis::Signals& signals) {
  for (const diagnosis::Effect& effect : model.effects) {
    for (const std::string& name : effect.channels) {
      if (std::ranges::find(signals.all(), name, &diagnosis::Signal::name) != signals.all().end()) {
        continue;
      }
      std::string names;
      for (const diagnosis::Channel& each : measurement.channels) names += ", " + each.name;
      throw ConfigError(measurement.source + ": effect '" + effect.kind + "'",
                        "no channel '" + name + "' among " + names.substr(2),
                        "the channels of the recording that the model was fitted to");
    }
  }
}

Prepared prepared(const diagnosis::Model& model, const Measurement& measurement) {
  Prepared made{model, measurement, 1, {}};
  Measurement& whole = made.whole;
  if (whole.find(model.output) == nullptr) {
    whole.channels.push_back(
        {model.output, model.output_unit, std::vector<double>(whole.size(), 0.0)});
  }
  made.factor = diagnosis::rate_factor(whole, model.rate_hz);
  made.working = made.factor == 1 ? whole : diagnosis::decimated(whole, made.factor);
  if (made.working.size() == 0) {
    throw ConfigError(whole.source, "no stretch as long as one sample of the model",
                      std::to_string(made.factor) + " samples or more without a gap");
  }
  return made;
}

diagnosis::FreeRun run_of(const Prepared& made, const diagnosis::Signals& signals) {
  try {
    diagnosis::FreeRun run = diagnosis::free_run(made.model, signals, false);
    if (run.finite) return run;
  } catch (const std::out_of_range&) {
    throw ConfigError("model", "an effect without all of its channels, parameters or coefficients",
                      "a model as `stillhand diagnose --save` writes");
  }
  throw ConfigError(made.whole.source, "inputs for which the model's output is not finite",
                    "inputs like those that the model was fitted to");
}

// The first samples of each stretch of the recording that has a stretch of the model.
diagnosis::GivenRows given_rows(const Prepared& made, std::size_t samples) {
  diagnosis::GivenRows rows;
  for (const diagnosis::Stretch& stretch : made.whole.stretches) {
    if (stretch.end - stretch.first < made.factor) continue;
    rows.emplace_back();
    for (std::size_t n = stretch.first; n < std::min(stretch.end, stretch.first + samples); ++n) {
      if (made.whole.weight[n] > 0.0) rows.back().push_back(n);
    }
  }
  return rows;
}

// Eq. DG-82.
diagnosis::Signals started_from_output(const Prepared& made, const diagnosis::Signals& signals,
                                       const diagnosis::GivenRows& rows) {
  const diagnosis::Answer answer = [&](const diagnosis::Signals& started) {
    return spread_out(run_of(made, started).prediction, made.working, made.whole, made.factor);
  };
  const auto states = diagnosis::most_likely_start(
      made.model, signals, diagnosis::spread_of(made.model, signals),
      made.whole.find(made.model.output)->values, rows, made.model.heldout_rmse, answer);
  return diagnosis::started(made.model, signals, states);
}

void check_start(const diagnosis::Model& model, const Measurement& measurement) {
  const diagnosis::Channel* output = measurement.find(model.output);
  if (output == nullptr || output->unit != model.output_unit) {
    throw ConfigError("--start-from-output",
                      "a recording without " + model.output + " [" + model.output_unit + "]",
                      "one that holds the output of the model");
  }
  if (!(model.heldout_rmse > 0.0)) {
    throw ConfigError("--start-from-output", "a model whose error is not known",
                      "one that `stillhand diagnose --save` of this version wrote");
  }
}

}  // namespace

Prediction predict(const diagnosis::CarriedModel& carried, const Measurement& measurement,
                   std::size_t start_samples) {
  check_inputs(carried, measurement);
  const Prepared made = prepared(carried.model, measurement);
  const diagnosis::Model& model = carried.model;
  const diagnosis::Signals measured(made.working, model.inputs, model.output);
  check_effects(model, measurement, measured);
  diagnosis::Signals signals = measured.with_pasts();
  std::vector<bool> given(made.whole.size(), false);
  if (start_samples > 0) {
    check_start(model, measurement);
    const auto rows = given_rows(made, start_samples);
    for (const auto& stretch : rows) {
      for (const std::size_t n : stretch) given[n] = true;
    }
    signals = started_from_output(made, measured, rows);
  }
  const diagnosis::FreeRun run = run_of(made, signals);
  Prediction prediction;
  prediction.output = model.output;
  prediction.notes = measurement.notes;
  prediction.screening = measurement.screening;
  add_notes(carried, prediction);
  add_ranges(diagnosis::left_ranges(model, carried.inputs, signals, run), prediction);
  add_bands(carried.bands, measured, prediction);
  const auto values =
      spread_out(start_samples > 0 ? run.prediction : measured.without_pasts(run.prediction),
                 made.working, made.whole, made.factor);
  const std::vector<double> time_s = made.whole.time_s();
  recording::Column column{model.output + "_model", model.output_unit, {}};
  std::size_t left_out = 0;
  for (std::size_t n = 0; n < made.whole.size(); ++n) {
    if (made.whole.weight[n] <= 0.0) continue;
    if (std::isnan(values[n])) {
      ++left_out;
      continue;
    }
    prediction.table.time_s.push_back(time_s[n]);
    prediction.given.push_back(given[n]);
    column.values.push_back(values[n]);
  }
  const auto scored = static_cast<std::size_t>(std::ranges::count(prediction.given, false));
  if (start_samples > 0 && scored < kLeastScored) {
    throw ConfigError("--start-from-output",
                      std::to_string(start_samples) + ", which leaves " + std::to_string(scored) +
                          " rows to predict",
                      "so few that " + std::to_string(kLeastScored) + " or more are left");
  }
  if (left_out > 0) {
    prediction.notes.push_back(std::to_string(left_out) +
                               " rows left out, in stretches shorter than one sample of the model");
  }
  prediction.table.columns.push_back(std::move(column));
  return prediction;
}

}  // namespace stillhand::predict
