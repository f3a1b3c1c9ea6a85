// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>

#include "apps/libraries/measurement/bridge.hpp"
#include "apps/libraries/measurement/row_clock.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

using diagnosis::Measurement;

constexpr double kLeastStretch_s = 1.0;
constexpr std::size_t kLeastStretch_samples = 20;
// A hand moves at 0.1 to 10 Hz, which a slower recording doesn't show.
constexpr double kSlowRate_hz = 5.0;

// "1 row", "2 rows"
std::string counted(double count, const std::string& what) {
  return fmt::format("{:.15g} {}{}", count, what, count == 1.0 ? "" : "s");
}
std::string counted(std::size_t count, const std::string& what) {
  return counted(static_cast<double>(count), what);
}

std::string figure(double value) { return fmt::format("{:.4g}", value); }

// A stretch of less than 20 samples holds no information.  One of less than a second adds hardly
// any to a longer one.
void leave_out_short(RowPlaces& places, std::vector<std::string>& notes) {
  std::size_t longest = 0;
  for (const RowStretch& stretch : places.stretches) {
    longest = std::max(longest, stretch.grid_samples);
  }
  const double second = kLeastStretch_s * places.rate_hz;
  const double least = std::max(static_cast<double>(kLeastStretch_samples),
                                static_cast<double>(longest) >= second ? second : 0.0);
  std::size_t rows = 0;
  std::erase_if(places.stretches, [&](const RowStretch& stretch) {
    const bool is_short = static_cast<double>(stretch.grid_samples) < least;
    if (is_short) rows += stretch.end_row - stretch.first_row;
    return is_short;
  });
  if (rows > 0) {
    notes.push_back(fmt::format("{} left out, in stretches shorter than {} s.",
                                counted(rows, "row"), figure(least / places.rate_hz)));
  }
}

std::size_t grid_size(const RowPlaces& places) {
  std::size_t samples = 0;
  for (const RowStretch& stretch : places.stretches) samples += stretch.grid_samples;
  return samples;
}

void note_slow_rows(double rate_hz, std::vector<std::string>& notes) {
  if (rate_hz >= kSlowRate_hz) return;
  notes.push_back(
      fmt::format("{} s between rows: no motion of a hand shows.", figure(1.0 / rate_hz)));
}

void check_size(const recording::Recording& rows, std::size_t samples, std::size_t most_values) {
  if (samples > most_values / rows.columns.size()) {
    throw ConfigError(rows.source,
                      counted(samples, "sample") + " of " + counted(rows.columns.size(), "channel"),
                      "at most " + std::to_string(most_values) +
                          " values; use a part of it, fewer channels or a lower rate");
  }
}

void note_what_happened(const RowPlaces& places, std::size_t long_gaps, std::size_t filled,
                        std::vector<std::string>& notes) {
  const std::string bridge_ms =
      figure(1e3 * static_cast<double>(longest_bridge(places.rate_hz)) / places.rate_hz);
  if (places.as_stamped) {
    notes.push_back(fmt::format(
        "The time stamps differ from an even grid by {} % of a period (median): resampled to {} Hz "
        "by cubic interpolation.",
        figure(100.0 * places.jitter_periods), figure(places.rate_hz)));
  }
  if (filled > 0) {
    notes.push_back(fmt::format(
        "{} missing in gaps of at most {} ms: filled in by cubic interpolation, with weight 0.",
        counted(filled, "row"), bridge_ms));
  }
  if (long_gaps > 0) {
    notes.push_back(
        fmt::format("{} missing in {} longer than {} ms: a new stretch begins after each.",
                    counted(places.lost_between, "row"), counted(long_gaps, "gap"), bridge_ms));
  }
}

void fill(Measurement& out, recording::Recording& rows, const RowPlaces& places) {
  const std::size_t samples = grid_size(places);
  const auto of_stretch = [&](const std::vector<double>& of_rows, const RowStretch& stretch) {
    return std::span(of_rows).subspan(stretch.first_row, stretch.end_row - stretch.first_row);
  };
  out.weight.reserve(samples);
  for (const RowStretch& stretch : places.stretches) {
    const std::size_t first = out.weight.size();
    append_weights(of_stretch(places.places, stretch), stretch.grid_samples, out.weight);
    out.stretches.push_back({first, out.weight.size(), stretch.start_s});
  }
  for (recording::Column& column : rows.columns) {
    diagnosis::Channel channel{std::move(column.name), std::move(column.unit), {}};
    channel.values.reserve(samples);
    for (const RowStretch& stretch : places.stretches) {
      append_on_grid(of_stretch(places.places, stretch), of_stretch(column.values, stretch),
                     stretch.grid_samples, channel.values);
    }
    column.values = {};
    out.channels.push_back(std::move(channel));
  }
}

void check_use(const Measurement& measurement, std::size_t rows, double rate_hz) {
  const auto measured = static_cast<std::size_t>(std::ranges::count(measurement.weight, 1.0));
  if (measured < kLeastSamples) {
    throw ConfigError(measurement.source,
                      counted(measured, "usable sample") + " in " + counted(rows, "row") + " at " +
                          figure(rate_hz) + " Hz",
                      "at least " + std::to_string(kLeastSamples) +
                          ", in stretches of 20 and more without a long gap");
  }
  if (measurement.size() - measured > measured) {
    throw ConfigError(measurement.source,
                      "more rows missing than there are, at " + figure(rate_hz) + " Hz",
                      "rows in even steps of time, most of them present");
  }
}

}  // namespace

Measurement on_grid(recording::Recording rows, std::size_t most_values) {
  const std::size_t row_count = rows.row_count();
  RowPlaces places = place_rows(rows);
  rows.time_s = {};
  Measurement out;
  out.source = rows.source;
  out.rate_hz = places.rate_hz;
  const std::size_t long_gaps = places.stretches.size() - 1;
  std::vector<std::string> left_out;
  leave_out_short(places, left_out);
  check_size(rows, grid_size(places), most_values);
  fill(out, rows, places);
  check_use(out, row_count, places.rate_hz);
  const auto filled = static_cast<std::size_t>(std::ranges::count(out.weight, 0.0));
  note_slow_rows(places.rate_hz, out.notes);
  note_what_happened(places, long_gaps, filled, out.notes);
  out.notes.insert(out.notes.end(), left_out.begin(), left_out.end());
  if (rows.repeated_rows > 0) {
    out.notes.push_back(counted(rows.repeated_rows, "row") + " left out, equal to an earlier one.");
  }
  return out;
}

}  // namespace stillhand::measurement
