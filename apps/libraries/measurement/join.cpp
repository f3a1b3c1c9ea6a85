// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "apps/libraries/measurement/read.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

using diagnosis::Channel;
using diagnosis::Measurement;
using diagnosis::Stretch;

// A tenth of a percent: clocks of one rig agree to a hundredth of that, neighbouring rates that
// somebody would choose differ by more.
constexpr double kRateTolerance = 1e-3;

std::string title(const Channel& channel) { return channel.name + " [" + channel.unit + "]"; }

std::string list_of(const std::vector<Channel>& channels) {
  std::string text;
  for (const Channel& channel : channels) text += (text.empty() ? "" : ", ") + title(channel);
  return text;
}

void check_same_rig(const Measurement& one, const Measurement& other) {
  if (std::abs(other.rate_hz / one.rate_hz - 1.0) > kRateTolerance) {
    throw ConfigError(other.source, std::to_string(other.rate_hz) + " Hz",
                      std::to_string(one.rate_hz) + " Hz as " + one.source + " has");
  }
  for (const Channel& channel : one.channels) {
    const Channel* same = other.find(channel.name);
    if (same == nullptr) {
      throw ConfigError(other.source, "channels " + list_of(other.channels),
                        title(channel) + " too, as " + one.source + " has");
    }
    if (same->unit != channel.unit) {
      throw ConfigError(other.source, title(*same), title(channel) + " as " + one.source + " has");
    }
  }
  for (const Channel& channel : other.channels) {
    if (one.find(channel.name) == nullptr) {
      throw ConfigError(other.source, title(channel) + " in addition",
                        list_of(one.channels) + " as " + one.source + " has");
    }
  }
}

// A channel that the screening of one recording leaves out (an encoder that stands in a short run)
// is left out of all.
void leave_out_what_one_lacks(std::vector<Measurement>& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const diagnosis::SampleFault& fault : parts[i].screening) {
      if (parts[i].find(fault.channel) != nullptr) continue;
      for (Measurement& other : parts) {
        const auto is_it = [&](const Channel& each) { return each.name == fault.channel; };
        if (std::erase_if(other.channels, is_it) == 0) continue;
        other.notes.push_back(fault.channel + " left out, as in " + parts[i].source + ".");
      }
    }
  }
}

double end_s(const Measurement& measurement) {
  const Stretch& last = measurement.stretches.back();
  return last.start_s + static_cast<double>(last.end - last.first) / measurement.rate_hz;
}

void append(Measurement& whole, Measurement&& part) {
  const double later_s = end_s(whole) - part.stretches.front().start_s;
  const std::size_t before = whole.size();
  const std::size_t recordings = whole.stretches.back().recording + 1;
  for (const Stretch& stretch : part.stretches) {
    whole.stretches.push_back({before + stretch.first, before + stretch.end,
                               stretch.start_s + later_s, recordings + stretch.recording});
  }
  for (Channel& channel : whole.channels) {
    const std::vector<double>& values = part.find(channel.name)->values;
    channel.values.insert(channel.values.end(), values.begin(), values.end());
  }
  whole.weight.insert(whole.weight.end(), part.weight.begin(), part.weight.end());
  for (diagnosis::SampleFault& fault : part.screening) {
    for (double& time_s : fault.times_s) time_s += later_s;
    whole.screening.push_back(std::move(fault));
  }
  for (const std::string& note : part.notes) whole.notes.push_back(part.source + ": " + note);
  whole.source += ", " + part.source;
}

}  // namespace

Measurement join(std::vector<Measurement> parts) {
  if (parts.empty()) throw ConfigError("recordings", "none", "at least one");
  for (const Measurement& part : parts) check(part);
  leave_out_what_one_lacks(parts);
  for (const Measurement& part : parts) check_same_rig(parts.front(), part);
  Measurement whole = std::move(parts.front());
  if (parts.size() == 1) return whole;
  for (std::string& note : whole.notes) note.insert(0, whole.source + ": ");
  for (std::size_t i = 1; i < parts.size(); ++i) append(whole, std::move(parts[i]));
  return whole;
}

}  // namespace stillhand::measurement
