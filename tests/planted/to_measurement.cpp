// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/to_measurement.hpp"

#include <cmath>

namespace stillhand::planted {
namespace {

constexpr std::size_t kLongestFilled = 5;

/// Rows lost between row - 1 and row.
std::size_t lost_before(const Recording& recording, std::size_t row) {
  const double steps = (recording.time_s[row] - recording.time_s[row - 1]) * recording.rate_hz;
  return static_cast<std::size_t>(std::llround(steps)) - 1;
}

}  // namespace

diagnosis::Measurement to_measurement(const Recording& recording) {
  diagnosis::Measurement out;
  out.source = "planted";
  out.rate_hz = recording.rate_hz;
  for (std::size_t i = 0; i < recording.names.size(); ++i) {
    out.channels.push_back({recording.names[i], recording.units[i], {}});
  }
  std::size_t filled = 0;
  for (std::size_t row = 0; row < recording.time_s.size(); ++row) {
    const std::size_t lost = row == 0 ? kLongestFilled + 1 : lost_before(recording, row);
    if (lost > kLongestFilled) {
      if (!out.stretches.empty()) out.stretches.back().end = out.weight.size();
      out.stretches.push_back({out.weight.size(), 0, recording.time_s[row]});
    } else {
      for (std::size_t k = 1; k <= lost; ++k) {
        const double part = static_cast<double>(k) / static_cast<double>(lost + 1);
        for (std::size_t i = 0; i < recording.columns.size(); ++i) {
          const Series& column = recording.columns[i];
          out.channels[i].values.push_back((1.0 - part) * column[row - 1] + part * column[row]);
        }
        out.weight.push_back(0.0);
      }
      filled += lost;
    }
    for (std::size_t i = 0; i < recording.columns.size(); ++i) {
      out.channels[i].values.push_back(recording.columns[i][row]);
    }
    out.weight.push_back(1.0);
  }
  if (!out.stretches.empty()) out.stretches.back().end = out.weight.size();
  if (filled > 0) out.notes.push_back(std::to_string(filled) + " lost rows were filled in");
  if (out.stretches.size() > 1) {
    out.notes.push_back(std::to_string(out.stretches.size()) + " stretches between long gaps");
  }
  return out;
}

}  // namespace stillhand::planted
