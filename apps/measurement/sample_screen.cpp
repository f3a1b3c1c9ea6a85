// SPDX-License-Identifier: Apache-2.0
#include "apps/measurement/sample_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/measurement/sample_faults.hpp"
#include "services/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

using diagnosis::SampleFault;
using recording::Column;
using recording::Recording;

constexpr std::size_t kMostTimes = 10;
constexpr std::size_t kLeastRows = 200;  // two seconds of 100 Hz: fewer show no habit of a channel

bool is_input(const ModelChannels& channels, const std::string& name) {
  return std::ranges::find(channels.inputs, name) != channels.inputs.end();
}

SampleFault fault_of(const Recording& rows, const Column& column, const BadRows& bad) {
  SampleFault out{column.name, bad.what, {}, 0.0, {}, false};
  for (const EqualRun& place : bad.places) {
    if (out.times_s.size() < kMostTimes) out.times_s.push_back(rows.time_s[place.first]);
  }
  out.share = static_cast<double>(bad.rows()) / static_cast<double>(rows.row_count());
  return out;
}

std::string in_words(const BadRows& bad, const SampleFault& fault) {
  const std::string at = bad.detail.empty() ? "" : fmt::format(" at {}", bad.detail);
  return fmt::format("{}: {}{}, {:.3g} % of the rows in {} place{}, from {:.4g} s on",
                     fault.channel, bad.what, at, 100.0 * fault.share, bad.places.size(),
                     bad.places.size() == 1 ? "" : "s", fault.times_s.front());
}

// What one column's faults do to the rows and to the column.
struct Screened {
  std::vector<SampleFault> faults;
  std::vector<char> is_bad;  // rows to leave out
  std::vector<std::string> left_out;
};

void take_out(const Recording& rows, const Column& column, const ModelChannels& channels,
              const std::vector<BadRows>& found, Screened& out) {
  const bool of_model = is_input(channels, column.name) || column.name == channels.output;
  for (const BadRows& bad : found) {
    SampleFault fault = fault_of(rows, column, bad);
    fault.says = in_words(bad, fault);
    if (!of_model) {
      out.left_out.push_back(column.name);
      fault.says += "; the channel is left out.";
    } else if (2 * bad.rows() > rows.row_count()) {
      fault.unsound = true;
      fault.says += "; too many to leave them out.";
    } else {
      for (const EqualRun& place : bad.places) {
        std::fill(out.is_bad.begin() + static_cast<std::ptrdiff_t>(place.first),
                  out.is_bad.begin() + static_cast<std::ptrdiff_t>(place.end), 1);
      }
      fault.says += "; these rows are left out.";
    }
    out.faults.push_back(std::move(fault));
  }
}

// Every row alike: the channel carries nothing, or less than its rows say.
void judge_whole(const Recording& rows, const Column& column, const ModelChannels& channels,
                 const std::vector<EqualRun>& runs, Screened& out) {
  const bool of_model = is_input(channels, column.name) || column.name == channels.output;
  SampleFault fault{column.name, {}, {rows.time_s.front()}, 1.0, {}, of_model};
  if (counts_rows(column.values)) {
    fault.what = "counter";
    fault.says = column.name + ": a counter, whose steps are all equal";
    if (!of_model) {
      out.left_out.push_back(column.name);
      fault.says += "; the channel is left out";
    }
  } else if (const double held = of_model ? held_rows(column.values, runs) : 0.0; held > 0.0) {
    fault.what = "held";
    fault.says = fmt::format(
        "{}: each value is held for {:.3g} rows: {:.4g} Hz inside {:.4g} Hz, late by {:.3g} ms on "
        "the mean; record it at its own rate",
        column.name, held, rows.rate_hz / held, rows.rate_hz, 500.0 * (held - 1.0) / rows.rate_hz);
  } else {
    return;
  }
  fault.says += ".";
  out.faults.push_back(std::move(fault));
}

// Eq. ME-11: the mass that force and acceleration would make.
void judge_units(const Recording& rows, const ModelChannels& channels, Screened& out) {
  const Column* force = rows.find(channels.output);
  if (force == nullptr || force->unit != "N" || channels.inputs.size() != 1) return;
  const Column* input = rows.find(channels.inputs.front());
  if (input == nullptr || input->unit != "m/s^2") return;
  const auto rms = [&](const Column& column) {
    double mean = 0.0;
    double square = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      if (out.is_bad[i] != 0) continue;
      count += 1.0;
      const double from = column.values[i] - mean;
      mean += from / count;
      square += from * (column.values[i] - mean);
    }
    return std::sqrt(square / std::max(count, 1.0));
  };
  const double acceleration_m_s2 = rms(*input);
  const double force_n = rms(*force);
  if (!(acceleration_m_s2 > 0.0) || !(force_n > 0.0)) return;
  const double mass_kg = force_n / acceleration_m_s2;
  // From a finger's 10 g to twice a person on a seat.
  constexpr double kLightest_kg = 0.01;
  constexpr double kHeaviest_kg = 200.0;
  if (mass_kg >= kLightest_kg && mass_kg <= kHeaviest_kg) return;
  out.faults.push_back(
      {force->name,
       "unit",
       {rows.time_s.front()},
       1.0,
       fmt::format(
           "{}: {:.3g} N for {:.3g} m/s^2 of {} are a body of {:.3g} kg, and a hand's is {} "
           "to {} kg: one of the units is wrong.",
           force->name, force_n, acceleration_m_s2, input->name, mass_kg, kLightest_kg,
           kHeaviest_kg),
       true});
}

void leave_rows_out(Recording& rows, const std::vector<char>& is_bad) {
  if (std::ranges::count(is_bad, 1) == 0) return;
  const auto keep = [&](std::vector<double>& values) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (is_bad[i] == 0) values[kept++] = values[i];
    }
    values.resize(kept);
  };
  for (Column& column : rows.columns) keep(column.values);
  keep(rows.time_s);
  recording::estimate_timing(rows);
}

}  // namespace

std::vector<SampleFault> screen(Recording& rows, const ModelChannels& channels) {
  const std::size_t count = rows.row_count();
  if (count < kLeastRows) return {};
  Screened out{{}, std::vector<char>(count, 0), {}};
  for (const Column& column : rows.columns) {
    const auto [low, high] = std::ranges::minmax(column.values);
    if (low == high) continue;
    std::vector<char> is_bad(count, 0);
    const std::vector<EqualRun> runs = equal_runs(column.values);
    std::vector<BadRows> bad = far_values(column.values, is_bad);
    if (auto spikes = spikes_in(column.values, is_bad)) bad.push_back(std::move(*spikes));
    const bool rests = column.name != channels.output;
    if (auto stuck = stuck_in(column.values, runs, rows.rate_hz, rests, is_bad)) {
      bad.push_back(std::move(*stuck));
    }
    take_out(rows, column, channels, bad, out);
    if (const auto clipped = clipped_in(column.values, runs, is_bad)) {
      SampleFault fault = fault_of(rows, column, *clipped);
      fault.says = in_words(*clipped, fault) + "; they stay, as a limit of the channel.";
      out.faults.push_back(std::move(fault));
    }
    judge_whole(rows, column, channels, runs, out);
  }
  if (2 * static_cast<std::size_t>(std::ranges::count(out.is_bad, 1)) > count) {
    std::ranges::fill(out.is_bad, 0);
    for (SampleFault& fault : out.faults) fault.unsound = true;
  }
  judge_units(rows, channels, out);
  std::erase_if(rows.columns, [&](const Column& column) {
    return std::ranges::find(out.left_out, column.name) != out.left_out.end();
  });
  if (rows.columns.empty()) {
    throw ConfigError(rows.source, "no channel of measurements (" + out.faults.front().says + ")",
                      "one or more");
  }
  leave_rows_out(rows, out.is_bad);
  return out.faults;
}

}  // namespace stillhand::measurement
