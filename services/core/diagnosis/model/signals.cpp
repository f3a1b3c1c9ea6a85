// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/model/steady_start.hpp"
#include "services/core/diagnosis/record/excited_band.hpp"
#include "services/core/diagnosis/record/wide_sums.hpp"
#include "services/core/signal/butterworth.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kSameSignalCorrelation = 0.95;
constexpr double kUnjudged_s = 1.0;
constexpr double kPast_s = 10.0;  // Eq. DG-60
constexpr double kFade_s = 1.0;
constexpr double kUnjudgedShare = 0.1;  // of a stretch
constexpr double kIntegralHighPassHz = 0.1;

// Share of a past's swing that is left so long before a stretch.
double faded(double before_s) {
  return before_s < kFade_s ? 0.5 + 0.5 * std::cos(std::numbers::pi * before_s / kFade_s) : 0.0;
}

std::vector<double> central_difference(const std::vector<double>& x, double rate_hz,
                                       const std::vector<Stretch>& stretches) {
  std::vector<double> rate(x.size(), 0.0);
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      const std::size_t before = n > stretch.first ? n - 1 : n;
      const std::size_t after = n + 1 < stretch.end ? n + 1 : n;
      if (after > before) {
        rate[n] = (x[after] - x[before]) * rate_hz / static_cast<double>(after - before);
      }
    }
  }
  return rate;
}

std::vector<double> trapezoidal_sum(const std::vector<double>& x, double rate_hz,
                                    const std::vector<Stretch>& stretches) {
  std::vector<double> sum(x.size(), 0.0);
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.first + 1; n < stretch.end; ++n) {
      sum[n] = sum[n - 1] + 0.5 * (x[n - 1] + x[n]) / rate_hz;
    }
  }
  return sum;
}

void set_moments(Signal& of) {
  of.mean = signal::mean(of.values);
  of.deviation = std::sqrt(signal::mean_square(of.values, of.mean));
}

// A channel that explains nothing: constant but for its rounding, or what a filter's start has
// faded to.  No sensor resolves 1e-50 of an SI unit, and the sixth power of it still is a normal
// double.
bool is_constant(const Signal& signal) {
  constexpr double kRounding = 1e-12;  // of the mean
  constexpr double kFaded = 1e-50;
  return !(signal.deviation > std::max(kFaded, kRounding * std::abs(signal.mean)));
}

Signal from_channel(const Channel& channel) {
  Signal signal{channel.name, channel.name,  channel.unit, quantity_of(channel.unit),
                false,        channel.values};
  set_moments(signal);
  return signal;
}

const Channel& find_channel(const Measurement& measurement, const std::string& name,
                            const std::string& role) {
  const Channel* channel = measurement.find(name);
  if (channel != nullptr) return *channel;
  std::string names;
  for (const Channel& each : measurement.channels) names += (names.empty() ? "" : ", ") + each.name;
  throw ConfigError(measurement.source + ": " + role, "'" + name + "', which isn't there",
                    "one of " + names);
}

}  // namespace

Quantity quantity_of(std::string_view unit) noexcept {
  constexpr std::array<std::string_view, 5> kPositions{"m", "mm", "cm", "rad", "deg"};
  for (const std::string_view position : kPositions) {
    if (unit == position) return Quantity::kPosition;
    if (!unit.starts_with(position)) continue;
    const std::string_view rest = unit.substr(position.size());
    if (rest == "/s") return Quantity::kRate;
    if (rest == "/s^2") return Quantity::kAcceleration;
  }
  return Quantity::kOther;
}

Signals::Signals(const Measurement& measurement, const std::vector<std::string>& inputs,
                 const std::string& output)
    : rate_hz_((check(measurement), measurement.rate_hz)),
      stretches_(measurement.stretches),
      weight_(measurement.weight),
      time_s_(measurement.time_s()) {
  if (inputs.empty()) throw ConfigError("input", "none", "at least one channel");
  output_ = from_channel(find_channel(measurement, output, "output"));
  for (const std::string& name : inputs) {
    if (name == output) throw ConfigError("input", "'" + name + "', the output", "another channel");
    if (is_input(name)) throw ConfigError("input", "'" + name + "' twice", "each channel once");
    inputs_.push_back(from_channel(find_channel(measurement, name, "input")));
  }
  all_ = inputs_;
  for (const Channel& channel : measurement.channels) {
    if (channel.name == output || is_input(channel.name)) continue;
    Signal signal = from_channel(channel);
    if (!is_constant(signal)) all_.push_back(std::move(signal));
  }
  leave_starts_unjudged();
  add_derived();
  find_excited_band();
}

void Signals::leave_starts_unjudged() {
  for (const Stretch& stretch : stretches_) {
    const auto length = static_cast<double>(stretch.end - stretch.first);
    const auto unjudged =
        static_cast<std::size_t>(std::min(kUnjudged_s * rate_hz_, kUnjudgedShare * length));
    std::fill_n(weight_.begin() + static_cast<std::ptrdiff_t>(stretch.first), unjudged, 0.0);
  }
}

void Signals::find_excited_band() {
  lowest_excited_hz_ = 0.5 * rate_hz_;
  for (const Signal& input : inputs_) {
    const ExcitedBand band = excited_band(input.name, input.values, input.mean, rate_hz_);
    lowest_excited_hz_ = std::min(lowest_excited_hz_, band.low_hz);
    highest_excited_hz_ = std::max(highest_excited_hz_, band.high_hz);
  }
}

void Signals::add_derived() {
  const std::size_t measured = all_.size();
  for (std::size_t i = 0; i < measured; ++i) {
    const Signal& from = all_[i];
    Signal made{"", from.source, from.unit, Quantity::kOther, true, {}};
    Quantity sibling = Quantity::kOther;
    if (from.quantity == Quantity::kPosition) {
      made.name = "rate of " + from.name;
      made.unit = from.unit + "/s";
      made.quantity = sibling = Quantity::kRate;
      made.values = central_difference(from.values, rate_hz_, stretches_);
    } else if (from.quantity == Quantity::kRate) {
      made.name = "position of " + from.name;
      made.unit = from.unit.substr(0, from.unit.size() - 2);
      made.quantity = sibling = Quantity::kPosition;
      made.values = trapezoidal_sum(from.values, rate_hz_, stretches_);
    } else if (from.quantity == Quantity::kAcceleration) {
      made.name = "rate of " + from.name;
      made.unit = from.unit.substr(0, from.unit.size() - 2);
      made.quantity = sibling = Quantity::kRate;
      const signal::Butterworth high_pass(2, kIntegralHighPassHz, rate_hz_,
                                          signal::Passband::kHigh);
      // About the mean: the integral of an offset, such as gravity's, is a ramp.
      std::vector<double> moved = from.values;
      for (double& value : moved) value -= from.mean;
      made.values = signal::filtered(high_pass, trapezoidal_sum(moved, rate_hz_, stretches_));
    } else {
      continue;
    }
    // An integral's constant is unknown, so positions are compared by their rates.
    const auto is_it = [&](const Signal& each) {
      if (each.quantity != sibling || each.derived) return false;
      if (sibling == Quantity::kPosition) {
        const auto rate = central_difference(each.values, rate_hz_, stretches_);
        return signal::correlation(from.values, rate) > kSameSignalCorrelation;
      }
      return signal::correlation(each.values, made.values) > kSameSignalCorrelation;
    };
    if (std::any_of(all_.begin(), all_.begin() + static_cast<std::ptrdiff_t>(measured), is_it)) {
      continue;
    }
    set_moments(made);
    if (!is_constant(made)) all_.push_back(std::move(made));
  }
}

const Signal& Signals::at(std::string_view name) const {
  const auto found = std::ranges::find(all_, name, &Signal::name);
  if (found == all_.end()) {
    throw ConfigError("channel", "'" + std::string(name) + "', which isn't there",
                      "a channel of the recording");
  }
  return *found;
}

bool Signals::is_input(std::string_view name) const noexcept {
  return std::ranges::find(inputs_, name, &Signal::name) != inputs_.end();
}

const Signal* Signals::rate_of(const Signal& position) const noexcept {
  const auto difference = central_difference(position.values, rate_hz_, stretches_);
  for (const Signal& each : all_) {
    if (each.quantity != Quantity::kRate) continue;
    if (signal::correlation(each.values, difference) > kSameSignalCorrelation) return &each;
  }
  return nullptr;
}

Signals Signals::weighed(std::vector<double> weight) const {
  Signals other = *this;
  other.weight_ = std::move(weight);
  return other;
}

Signals Signals::whitened(std::vector<double> taps) const {
  Signals other = *this;
  other.whitening_ = std::move(taps);
  return other;
}

Signals Signals::with_slow_poles() const {
  Signals other = *this;
  other.slow_poles_ = true;
  return other;
}

Signals Signals::starting_by(std::vector<bool> rows) const {
  Signals other = *this;
  other.start_rows_ = std::move(rows);
  return other;
}

Signals Signals::with_start(Columns states) const {
  Signals other = *this;
  other.start_ = std::move(states);
  return other;
}

Signals Signals::restarted(const std::vector<std::size_t>& at) const {
  Signals other = *this;
  other.stretches_.clear();
  for (Stretch stretch : stretches_) {
    for (const std::size_t first : at) {
      if (first <= stretch.first || first >= stretch.end) continue;
      Stretch before = stretch;
      before.end = first;
      other.stretches_.push_back(before);
      stretch.first = first;
      stretch.start_s = time_s_[first];
    }
    other.stretches_.push_back(stretch);
  }
  other.leave_starts_unjudged();
  return other;
}

Signals Signals::cut_to(const std::vector<Stretch>& pieces) const {
  Signals other = *this;
  const auto cut = [&](std::vector<double>& values) {
    std::vector<double> kept;
    for (const Stretch& piece : pieces) {
      kept.insert(kept.end(), values.begin() + static_cast<std::ptrdiff_t>(piece.first),
                  values.begin() + static_cast<std::ptrdiff_t>(piece.end));
    }
    values = std::move(kept);
  };
  cut(other.weight_);
  cut(other.time_s_);
  cut(other.output_.values);
  for (auto* list : {&other.inputs_, &other.all_}) {
    for (Signal& signal : *list) cut(signal.values);
  }
  other.stretches_.clear();
  std::size_t end = 0;
  for (const Stretch& piece : pieces) {
    const std::size_t first = std::exchange(end, end + piece.end - piece.first);
    other.stretches_.push_back({first, end, time_s_[piece.first], piece.recording});
  }
  other.leave_starts_unjudged();
  return other;
}

// [samples]
std::size_t Signals::past_of(const Stretch& stretch) const {
  return std::min(stretch.end - stretch.first - 1, static_cast<std::size_t>(kPast_s * rate_hz_));
}

Signals Signals::with_pasts() const {
  Signals other = *this;
  other.stretches_.clear();
  other.weight_.clear();
  other.time_s_.clear();
  std::vector<std::size_t> from;  // the sample that each one repeats
  std::size_t pasts = 0;
  for (Stretch stretch : stretches_) {
    const std::size_t past = past_of(stretch);
    const std::size_t first = from.size();
    stretch.start_s += static_cast<double>(pasts) / rate_hz_;
    pasts += past;
    for (std::size_t n = past; n > 0; --n) from.push_back(stretch.first + n);
    for (std::size_t n = stretch.first; n < stretch.end; ++n) from.push_back(n);
    for (std::size_t n = first; n < from.size(); ++n) {
      other.time_s_.push_back(stretch.start_s + static_cast<double>(n - first) / rate_hz_);
      other.weight_.push_back(n < first + past ? 0.0 : weight_[from[n]]);
    }
    stretch.first = first;
    stretch.end = from.size();
    other.stretches_.push_back(stretch);
  }
  const auto repeat = [&](Signal& signal) {
    const std::vector<double> levels = start_levels(signal.values, *this);
    std::vector<double> values;
    values.reserve(from.size());
    for (const std::size_t n : from) values.push_back(signal.values[n]);
    for (std::size_t i = 0; i < stretches_.size(); ++i) {
      const std::size_t past = past_of(stretches_[i]);
      for (std::size_t n = 1; n <= past; ++n) {
        double& x = values[other.stretches_[i].first + past - n];
        x = levels[i] + faded(static_cast<double>(n) / rate_hz_) * (x - levels[i]);
      }
    }
    signal.values = std::move(values);
  };
  repeat(other.output_);
  std::ranges::for_each(other.inputs_, repeat);
  std::ranges::for_each(other.all_, repeat);
  return other;
}

std::vector<double> Signals::without_pasts(const std::vector<double>& run) const {
  std::vector<double> out;
  out.reserve(size());
  auto at = run.begin();
  for (const Stretch& stretch : stretches_) {
    at += static_cast<std::ptrdiff_t>(past_of(stretch));
    const auto end = at + static_cast<std::ptrdiff_t>(stretch.end - stretch.first);
    out.insert(out.end(), at, end);
    at = end;
  }
  return out;
}

void Signals::whiten(Eigen::Ref<Eigen::MatrixXd> columns, const std::vector<double>& weight) const {
  if (whitening_.empty()) return;
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    double* const x = columns.col(c).data();
    for (const Stretch& stretch : stretches_) {
      filter_in_place(whitening_, {x + stretch.first, stretch.end - stretch.first});
    }
    for (std::size_t n = 0; n < weight.size(); ++n) {
      if (!(weight[n] > 0.0)) x[n] = 0.0;
    }
  }
}

Signals Signals::replaced(std::string_view name, std::vector<double> values) const {
  Signals other = *this;
  const auto found = std::ranges::find(other.all_, name, &Signal::name);
  if (found != other.all_.end()) found->values = std::move(values);
  return other;
}

Signals Signals::moved(
    const std::function<std::vector<double>(const Signal& signal)>& values) const {
  Signals other = *this;
  for (auto* list : {&other.inputs_, &other.all_}) {
    for (Signal& signal : *list) signal.values = values(signal);
  }
  return other;
}

Signals Signals::within(const std::vector<SeenRange>& ranges) const {
  Signals other = *this;
  for (const SeenRange& range : ranges) {
    const auto found = std::ranges::find(other.all_, range.of, &Signal::name);
    if (found == other.all_.end()) continue;
    for (double& value : found->values) value = range.held(value);
  }
  return other;
}

std::string unit_power(const std::string& unit, int exponent) {
  if (unit.empty() || unit == "-" || unit == "1") return "-";
  const bool whole = unit.find_first_of("/*^ ") == std::string::npos;
  return (whole ? unit : "(" + unit + ")") + "^" + std::to_string(exponent);
}

}  // namespace stillhand::diagnosis
