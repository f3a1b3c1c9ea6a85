// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <utility>

#include "apps/libraries/measurement/grid.hpp"
#include "apps/libraries/measurement/session.hpp"
#include "apps/libraries/measurement/tables/apply_mapping.hpp"
#include "apps/libraries/measurement/tables/bag_table.hpp"
#include "apps/libraries/session/lateness_channels.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::measurement {
namespace {

// A hand moves at 0.1 to 10 Hz, which fewer rows a second don't show.
constexpr double kLeastHandRate_hz = 5.0;

// A table whose 't [ms]' holds seconds looks like a fast one that ends within a blink.  At 10 Hz,
// the fastest that a hand moves, a second holds ten periods; fewer show no response.
constexpr double kFast_hz = 5e3;
constexpr double kBlink_s = 1.0;

// In which a hand's motion and force are judged.
constexpr std::array<std::string_view, 2> kHandsUnits{"m/s^2", "N"};

bool is_chosen(const std::string& name, const ModelChannels& chosen) {
  return name == chosen.output || std::ranges::find(chosen.inputs, name) != chosen.inputs.end();
}

std::string hands_channel(const diagnosis::Measurement& measurement, const ModelChannels& chosen) {
  for (const diagnosis::Channel& channel : measurement.channels) {
    const bool in_its_unit = std::ranges::find(kHandsUnits, channel.unit) != kHandsUnits.end();
    if (!si_unit(channel.name).empty() || (in_its_unit && is_chosen(channel.name, chosen))) {
      return channel.name;
    }
  }
  return {};
}

// A column that is chosen under its own title, "Acc Y (g)", is judged as one that is mapped.
void convert_chosen(recording::Recording& rows, const ModelChannels& chosen,
                    std::vector<std::string>& notes) {
  for (recording::Column& column : rows.columns) {
    if (!si_unit(column.name).empty() || !is_chosen(column.name, chosen)) continue;
    for (const std::string_view unit : kHandsUnits) {
      const auto conversion = unit_conversion(column.unit, {}, std::string(unit));
      if (!conversion || column.unit == unit) continue;
      conversion->apply(column.values);
      notes.push_back(fmt::format("{} from [{}] to [{}].", column.name, column.unit, unit));
      column.unit = unit;
    }
  }
}

// A factor of the times that makes the rate one of a laboratory's sensors; 0: none of the usual.
double likely_factor(double rate_hz) {
  constexpr double kLeast_hz = 50.0;
  constexpr double kMost_hz = 5000.0;
  for (const double factor : {1e3, 1e-3, 86400.0, 1e6, 1e-6, 1e9, 1e-9}) {
    if (rate_hz / factor >= kLeast_hz && rate_hz / factor <= kMost_hz) return factor;
  }
  return 0.0;
}

std::string other_unit(double rate_hz) {
  const double factor = likely_factor(rate_hz);
  if (rate_hz == 1.0) {
    return "if the column counts rows: --sample-rate HZ and no column of times; if it holds "
           "milliseconds: --map 'TITLE=t [ms]' and the other columns";
  }
  if (factor == 0.0) return "is the unit of the times the one that the title states?";
  return fmt::format(
      "if the times are in another unit, of {:.4g} Hz, although the title says "
      "otherwise: --map 'TITLE={}' and the other columns",
      rate_hz / factor, factor == 1e-3 ? std::string("t [ms]") : fmt::format("t * {:g}", factor));
}

void refuse_blink(const diagnosis::Measurement& measurement, const ModelChannels& chosen) {
  const double length_s = static_cast<double>(measurement.size()) / measurement.rate_hz;
  const std::string hand = hands_channel(measurement, chosen);
  if (hand.empty() || measurement.rate_hz < kFast_hz || length_s >= kBlink_s) return;
  throw ConfigError(
      measurement.source + ", time",
      fmt::format("{:.4g} Hz and {:.3g} s in all, of {}", measurement.rate_hz, length_s, hand),
      fmt::format("at least {:g} s; {}", kBlink_s, other_unit(measurement.rate_hz)));
}

// A table whose 't [s]' holds milliseconds looks like one of a very slow sensor.  Slow sensors
// exist, but none measures the motion or the force of a hand.
void refuse_slow_hand(const diagnosis::Measurement& measurement, const ModelChannels& chosen) {
  const std::string hand = hands_channel(measurement, chosen);
  if (hand.empty() || measurement.rate_hz >= kLeastHandRate_hz) return;
  throw ConfigError(measurement.source + ", time",
                    fmt::format("{:.4g} s between rows of {}", 1.0 / measurement.rate_hz, hand),
                    fmt::format("at most {:.4g} s; {}", 1.0 / kLeastHandRate_hz,
                                other_unit(measurement.rate_hz)));
}

// Every recording comes this way.
diagnosis::Measurement screened(recording::Recording rows, const ReadOptions& options,
                                const std::vector<std::string>& notes,
                                const std::vector<BackStep>& back_steps = {}) {
  std::vector<diagnosis::SampleFault> faults = screen(rows, options.channels);
  for (const BackStep& step : back_steps) {
    faults.push_back({"t",
                      "time_goes_back",
                      {step.time_s},
                      0.0,
                      fmt::format("t: the stamps go back by {:.4g} s after {:.4g} s: a new stretch "
                                  "begins there, and time goes on.",
                                  step.back_s, step.time_s)});
  }
  diagnosis::Measurement out = on_grid(std::move(rows), options.most_values);
  std::vector<std::string> before = notes;
  for (const diagnosis::SampleFault& fault : faults) before.push_back(fault.says);
  out.notes.insert(out.notes.begin(), before.begin(), before.end());
  out.screening = std::move(faults);
  return out;
}

// Where the recording lacks a step of the rig, its channels hold those of the step before.
void add_lateness(const std::string& path, recording::Recording& rows) {
  const recording::Recording all = session::lateness_channels(session::read_session(path));
  if (all.time_s.empty()) return;
  for (const recording::Column& channel : all.columns) {
    recording::Column column{channel.name, channel.unit, {}};
    for (const double time_s : rows.time_s) {
      const auto behind = std::ranges::upper_bound(all.time_s, time_s + 0.5 * kControlPeriod_s);
      const auto place = std::max<std::ptrdiff_t>(behind - all.time_s.begin() - 1, 0);
      column.values.push_back(channel.values[static_cast<std::size_t>(place)]);
    }
    rows.columns.push_back(std::move(column));
  }
}

diagnosis::Measurement read_session(const std::string& path, const ReadOptions& options) {
  SessionRows session = options.session_trial.empty()
                            ? read_session_rows(path, options.trial)
                            : read_session_rows(path, options.session_trial, true);
  if (!session.loss.empty()) runtime::remark(session.loss);
  if (options.lateness) add_lateness(path, session.rows);
  diagnosis::Measurement out = screened(std::move(session.rows), options, session.notes);
  if (!session.moves.empty()) {
    const std::string says = fmt::format(
        "f: in trial {} the stick moves, so f is the force of stick and motor at the "
        "hand, not that of a body on a held stick; the pegged trial has it",
        session.moves);
    out.notes.push_back(says);
    out.screening.push_back(
        {"f", "stick_moves", {out.time_s().front()}, 1.0, says, !options.lateness});
  }
  return out;
}

// The mapping of a file; signs and sample rate that are options count before those of a file.
Mapping mapping_for(const std::string& path, const ReadOptions& options) {
  if (options.map_file.empty()) return options.mapping;
  std::error_code error;
  const bool there = std::filesystem::exists(options.map_file, error);
  if (there && std::filesystem::equivalent(path, options.map_file, error)) {
    throw ConfigError("--map-file", options.map_file + ", the recording itself",
                      "a file of its own");
  }
  if (!there && !options.ask) {
    throw ConfigError("--map-file", options.map_file + ", which is not there",
                      "a mapping file, or a terminal on which it can be asked for");
  }
  if (!there) return options.mapping;
  if (std::filesystem::is_directory(options.map_file, error)) {
    throw ConfigError("--map-file", options.map_file + ", a folder", "a mapping file");
  }
  Mapping mapping = read_mapping(options.map_file);
  if (options.mapping.rate_hz) mapping.rate_hz = options.mapping.rate_hz;
  if (options.mapping.form.separator != 0) mapping.form.separator = options.mapping.form.separator;
  if (options.mapping.form.decimal != 0) mapping.form.decimal = options.mapping.form.decimal;
  return mapping;
}

// Asks for the mapping and writes it down, if the file is to be made.
void ask_if_needed(TableFile& file, const ReadOptions& options, Mapping& mapping) {
  if (options.map_file.empty() || std::filesystem::exists(options.map_file)) return;
  const Mapping stated = mapping;
  mapping = options.ask(file);
  mapping.form = stated.form;
  if (stated.rate_hz) mapping.rate_hz = stated.rate_hz;
  const recording::Status status =
      recording::write_file_atomically(options.map_file, mapping_yaml(mapping, file.head().path));
  if (!status.ok()) throw ConfigError("--map-file", status.text, "a place that can be written");
}

diagnosis::Measurement read_table(const std::string& path, const ReadOptions& options) {
  Mapping mapping = mapping_for(path, options);
  std::unique_ptr<TableFile> file = open_table(path, mapping.form, options.most_values);
  ask_if_needed(*file, options, mapping);
  MappedRows mapped = apply_mapping(*file, mapping);
  if (!mapped.loss.empty()) runtime::remark(mapped.loss);
  file.reset();  // a text is as large as its numbers
  convert_chosen(mapped.rows, options.channels, mapped.notes);
  diagnosis::Measurement out =
      screened(std::move(mapped.rows), options, mapped.notes, mapped.back_steps);
  refuse_blink(out, options.channels);
  refuse_slow_hand(out, options.channels);
  return out;
}

}  // namespace

diagnosis::Measurement read_measurement(const std::string& path, const ReadOptions& options) {
  const bool mapped = !options.mapping.empty() || !options.map_file.empty();
  if (kind_of(path) == FileKind::kMcap && !mapped && is_session(path))
    return read_session(path, options);
  if (!options.trial.empty()) {
    throw ConfigError("--trial", options.trial + " with the table " + path,
                      "no --trial, or the recording of a session (MCAP) without --map");
  }
  return read_table(path, options);
}

}  // namespace stillhand::measurement
