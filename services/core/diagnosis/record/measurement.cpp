// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/record/measurement.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/record/digits.hpp"

namespace stillhand::diagnosis {
namespace {

std::string samples(std::size_t count) { return std::to_string(count) + " samples"; }

// Squares of squares of it are still numbers.
constexpr double kLargestValue = 1e30;
// The engine counts samples in spans of seconds: such a count has to fit its integer.
constexpr double kHighestRate_hz = 1e12;

void check_values(const Measurement& measurement) {
  for (const Channel& channel : measurement.channels) {
    const std::string where = measurement.source + ", channel " + channel.name;
    if (channel.values.size() != measurement.size()) {
      throw ConfigError(where, samples(channel.values.size()),
                        samples(measurement.size()) + ", as there are weights");
    }
    const auto odd = std::ranges::find_if_not(
        channel.values, [](double value) { return std::abs(value) < kLargestValue; });
    if (odd != channel.values.end()) {
      throw ConfigError(where + ", sample " + std::to_string(odd - channel.values.begin()),
                        digits(*odd, 3), "a finite number, below 1e30 in size");
    }
  }
  const auto odd = std::ranges::find_if_not(
      measurement.weight, [](double weight) { return weight >= 0.0 && weight <= 1.0; });
  if (odd != measurement.weight.end()) {
    throw ConfigError(measurement.source + ", weight of sample " +
                          std::to_string(odd - measurement.weight.begin()),
                      std::to_string(*odd), "0 to 1");
  }
}

void check_stretches(const Measurement& measurement) {
  std::size_t covered = 0;
  double end_s = 0.0;
  for (std::size_t i = 0; i < measurement.stretches.size(); ++i) {
    const Stretch& stretch = measurement.stretches[i];
    const std::string where = measurement.source + ", stretch " + std::to_string(i);
    if (stretch.first != covered || stretch.end <= stretch.first) {
      throw ConfigError(where,
                        "samples from " + std::to_string(stretch.first) + " to before " +
                            std::to_string(stretch.end),
                        "some, from " + std::to_string(covered) + " on");
    }
    if (!std::isfinite(stretch.start_s) ||
        (i > 0 && stretch.start_s < end_s - 0.5 / measurement.rate_hz)) {
      throw ConfigError(where, "a start at " + std::to_string(stretch.start_s) + " s",
                        "one after the end of the stretch before");
    }
    covered = stretch.end;
    end_s =
        stretch.start_s + static_cast<double>(stretch.end - stretch.first) / measurement.rate_hz;
  }
  if (covered != measurement.size()) {
    throw ConfigError(measurement.source, "stretches of " + samples(covered),
                      "of all " + samples(measurement.size()));
  }
}

}  // namespace

const Channel* Measurement::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(channels, name, &Channel::name);
  return found == channels.end() ? nullptr : &*found;
}

std::vector<double> Measurement::time_s() const {
  std::vector<double> time_s(size());
  for (const Stretch& stretch : stretches) {
    for (std::size_t i = stretch.first; i < stretch.end; ++i) {
      time_s[i] = stretch.start_s + static_cast<double>(i - stretch.first) / rate_hz;
    }
  }
  return time_s;
}

std::string why_unsound(const Measurement& measurement, const std::vector<std::string>& channels) {
  for (const SampleFault& fault : measurement.screening) {
    if (fault.unsound && std::ranges::find(channels, fault.channel) != channels.end()) {
      return fault.says;
    }
  }
  return {};
}

void check(const Measurement& measurement) {
  if (!(measurement.rate_hz > 0.0) || !(measurement.rate_hz <= kHighestRate_hz)) {
    throw ConfigError(measurement.source + ", rate", digits(measurement.rate_hz, 3) + " Hz",
                      "a rate above 0, of at most 1e12 Hz");
  }
  check_values(measurement);
  check_stretches(measurement);
}

}  // namespace stillhand::diagnosis
