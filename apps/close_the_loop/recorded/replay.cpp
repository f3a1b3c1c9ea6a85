// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/recorded/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/libraries/measurement/bridge.hpp"
#include "apps/predict/predict.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/rig/rig.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::close_the_loop {
namespace {

// A model does not know what came before a stretch; a motor's model also settles and fades in.
constexpr double kSettle_s = 2.0;
constexpr double kBlock_s = 10.0;
constexpr double kExcerpt_s = 12.0;
constexpr std::size_t kLeastBlocks = 3;

constexpr Flags kLimited = kSaturated | kSlewLimited;

// Force and what is left of it, sample by sample, in runs without a gap.
struct Run {
  std::vector<double> force;
  std::vector<double> left;
};

double mean_over(const std::vector<Run>& runs, const std::vector<double> Run::* of) {
  double sum = 0.0;
  double count = 0.0;
  for (const Run& run : runs) {
    sum = std::accumulate((run.*of).begin(), (run.*of).end(), sum);
    count += static_cast<double>((run.*of).size());
  }
  return sum / count;
}

// Of whole blocks.
void set_from_blocks(Level& level) {
  const auto interval = statistics::mean_interval(level.block_mean_squares);
  level.rms = std::sqrt(interval.mean);
  level.interval95 = {std::sqrt(std::max(interval.low, 0.0)), std::sqrt(interval.high)};
}

// Eq. CL-6; incomplete blocks count only if there is no interval.
Level level_of(const std::vector<Run>& runs, const std::vector<double> Run::* of, double rate_hz) {
  const double mean = mean_over(runs, of);
  const auto length = static_cast<std::size_t>(kBlock_s * rate_hz);
  Level out;
  double square = 0.0;
  double count = 0.0;
  for (const Run& run : runs) {
    double block = 0.0;
    std::size_t in_block = 0;
    for (const double value : run.*of) {
      block += (value - mean) * (value - mean);
      square += (value - mean) * (value - mean);
      count += 1.0;
      if (++in_block < length) continue;
      out.block_mean_squares.push_back(block / static_cast<double>(length));
      block = 0.0;
      in_block = 0;
    }
  }
  out.rms = std::sqrt(square / count);
  if (out.block_mean_squares.size() >= kLeastBlocks) set_from_blocks(out);
  return out;
}

Excerpt excerpt_of(const std::vector<Run>& runs, double rate_hz) {
  const Run& longest =
      *std::ranges::max_element(runs, {}, [](const Run& run) { return run.force.size(); });
  const std::size_t count =
      std::min(longest.force.size(), static_cast<std::size_t>(kExcerpt_s * rate_hz));
  const auto from = static_cast<std::ptrdiff_t>((longest.force.size() - count) / 2);
  const auto to = from + static_cast<std::ptrdiff_t>(count);
  return {rate_hz,
          {longest.force.begin() + from, longest.force.begin() + to},
          {longest.left.begin() + from, longest.left.begin() + to}};
}

Remaining remaining(const std::vector<Run>& runs, double rate_hz, const std::string& source) {
  const bool empty = std::ranges::all_of(runs, [](const Run& run) { return run.force.empty(); });
  if (empty) {
    throw ConfigError(source, "no stretch that goes on when the model has settled",
                      "10 s or more without a gap");
  }
  Remaining out{level_of(runs, &Run::force, rate_hz), level_of(runs, &Run::left, rate_hz),
                excerpt_of(runs, rate_hz)};
  constexpr double kLeastShare = 1e-6;  // of the largest value: less is rounding
  double largest = 0.0;
  for (const Run& run : runs) {
    for (const double value : run.force) largest = std::max(largest, std::abs(value));
  }
  if (out.without.rms <= kLeastShare * largest) {
    throw ConfigError(source, "a constant output", "a record in which it changes");
  }
  return out;
}

const diagnosis::Channel& channel_of(const diagnosis::Measurement& record,
                                     const std::string& name) {
  const diagnosis::Channel* found = record.find(name);
  if (found == nullptr) {
    throw ConfigError(record.source, "no channel " + name, "a recording with it");
  }
  return *found;
}

}  // namespace

std::vector<double> at_control_rate(const std::vector<double>& values,
                                    const diagnosis::Stretch& stretch, double rate_hz) {
  const double factor = kControlRateHz / rate_hz;
  const std::size_t length = stretch.end - stretch.first;
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(stretch.first);
  std::vector<double> out;
  std::vector<double> places(length);
  for (std::size_t i = 0; i < length; ++i) places[i] = static_cast<double>(i) * factor;
  measurement::append_on_grid(
      places, {first, first + static_cast<std::ptrdiff_t>(length)},
      static_cast<std::size_t>(static_cast<double>(length - 1) * factor) + 1, out);
  return out;
}

std::vector<cancellation::ChannelSample> sensed(const diagnosis::Measurement& record,
                                                const diagnosis::Stretch& stretch) {
  std::vector<cancellation::ChannelSample> out;
  for (std::size_t c = 0; c < cancellation::kChannels; ++c) {
    const diagnosis::Channel* found = record.find(cancellation::kChannelFacts[c].name);
    if (found == nullptr) continue;
    const std::vector<double> values = at_control_rate(found->values, stretch, record.rate_hz);
    out.resize(values.size());
    for (std::size_t n = 0; n < values.size(); ++n) out[n][c] = values[n];
  }
  return out;
}

namespace {

// Motor force at the hand, tick by tick, for the motion of a stretch.
struct MotorRun {
  std::vector<double> force_n;
  std::vector<bool> limited;  ///< the canceller wanted more, or sooner
};

MotorRun motor_run(const cancellation::ControlModel& model,
                   const std::vector<cancellation::ChannelSample>& motion, double late_s) {
  cancellation::Countermeasure canceller({}, {.force = true});
  require_taken(canceller.load_model(model), "the canceller's model",
                "one that the canceller accepts");
  rig::RigConfig rig;
  rig.motor.delay_s = late_s;
  rig::Motor motor(rig.motor, rig.stick.lever_m);
  MotorRun out;
  cancellation::CountermeasureOutput command{};
  for (std::size_t n = 0; n < motion.size(); ++n) {
    out.force_n.push_back(motor.step({n > 0, 1, command.force_n, true}).force_n);
    command = canceller.step({static_cast<Tick>(n + 1), motion[n], 0, true, true, {}});
    out.limited.push_back((command.flags & kLimited) != 0);
  }
  return out;
}

}  // namespace

std::optional<std::pair<double, double>> Remaining::cut_interval95() const {
  const std::size_t blocks =
      std::min(left.block_mean_squares.size(), without.block_mean_squares.size());
  if (blocks < kLeastBlocks) return std::nullopt;
  const auto ratio =
      statistics::ratio_interval(left.block_mean_squares, without.block_mean_squares);
  if (!ratio) return std::nullopt;
  return std::pair{1.0 - std::sqrt(std::max(ratio->high, 0.0)),
                   1.0 - std::sqrt(std::max(ratio->low, 0.0))};
}

Remaining left_by_prediction(const diagnosis::CarriedModel& model,
                             const diagnosis::Measurement& record) {
  const recording::Recording predicted = predict::predict(model, record).table;
  const std::vector<double>& force = channel_of(record, model.model.output).values;
  const std::vector<double> time_s = record.time_s();
  std::vector<Run> runs;
  std::size_t row = 0;
  for (const diagnosis::Stretch& stretch : record.stretches) {
    runs.emplace_back();
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      while (row < predicted.time_s.size() && predicted.time_s[row] < time_s[n]) ++row;
      if (row == predicted.time_s.size()) break;
      if (predicted.time_s[row] != time_s[n] || time_s[n] - stretch.start_s < kSettle_s) continue;
      runs.back().force.push_back(force[n]);
      runs.back().left.push_back(force[n] - predicted.columns.front().values[row]);
    }
  }
  return remaining(runs, record.rate_hz, record.source);
}

double settled_after_s(const cancellation::ControlModel& model) {
  const cancellation::Config config;
  const auto ticks = cancellation::check_model(model, cancellation::bounds(config)).settle_ticks +
                     config.fade_ticks;
  return kSettle_s + static_cast<double>(ticks) * kControlPeriod_s;
}

Level pooled(const std::vector<Level>& levels, const std::vector<double>& seconds) {
  Level out;
  double square = 0.0;
  double time_s = 0.0;
  for (std::size_t r = 0; r < levels.size(); ++r) {
    const std::vector<double>& blocks = levels[r].block_mean_squares;
    out.block_mean_squares.insert(out.block_mean_squares.end(), blocks.begin(), blocks.end());
    square += levels[r].rms * levels[r].rms * seconds.at(r);
    time_s += seconds.at(r);
  }
  out.rms = std::sqrt(square / time_s);
  if (out.block_mean_squares.size() >= kLeastBlocks) set_from_blocks(out);
  return out;
}

Level explained_beyond(const Level& left_before, const Level& left_after) {
  const auto root = [](double square) { return std::sqrt(std::max(square, 0.0)); };
  Level out;
  out.rms = root(left_before.rms * left_before.rms - left_after.rms * left_after.rms);
  const std::size_t blocks =
      std::min(left_before.block_mean_squares.size(), left_after.block_mean_squares.size());
  for (std::size_t b = 0; b < blocks; ++b) {
    out.block_mean_squares.push_back(left_before.block_mean_squares[b] -
                                     left_after.block_mean_squares[b]);
  }
  if (blocks >= kLeastBlocks) {
    const auto interval = statistics::mean_interval(out.block_mean_squares);
    out.interval95 = {root(interval.low), root(interval.high)};
  }
  return out;
}

Remaining left_by_motor(const cancellation::ControlModel& model,
                        const diagnosis::Measurement& record, const std::string& output,
                        double late_s, double from_s) {
  const std::vector<double>& force = channel_of(record, output).values;
  const auto settle = static_cast<std::size_t>(
      std::lround(std::max(from_s, settled_after_s(model)) * kControlRateHz));
  std::vector<Run> runs;
  double limited = 0.0;
  double count = 0.0;
  for (const diagnosis::Stretch& stretch : record.stretches) {
    if (stretch.end - stretch.first < 2) continue;
    const MotorRun motor = motor_run(model, sensed(record, stretch), late_s);
    const std::vector<double> felt = at_control_rate(force, stretch, record.rate_hz);
    const std::vector<double> counts = at_control_rate(record.weight, stretch, record.rate_hz);
    runs.emplace_back();
    for (std::size_t n = settle; n < motor.force_n.size(); ++n) {
      if (counts[n] < 0.5) continue;
      runs.back().force.push_back(felt[n]);
      runs.back().left.push_back(felt[n] + motor.force_n[n]);
      limited += motor.limited[n] ? 1.0 : 0.0;
      count += 1.0;
    }
  }
  Remaining out = remaining(runs, kControlRateHz, record.source);
  out.limited_share = limited / count;
  return out;
}

std::pair<diagnosis::Measurement, diagnosis::Measurement> split_off_end(
    const diagnosis::Measurement& record, double share) {
  const auto cut =
      static_cast<std::size_t>(std::lround((1.0 - share) * static_cast<double>(record.size())));
  const auto part = [&](std::size_t from, std::size_t to) {
    diagnosis::Measurement out;
    out.source = record.source;
    out.rate_hz = record.rate_hz;
    out.notes = record.notes;
    const auto begin = static_cast<std::ptrdiff_t>(from);
    const auto end = static_cast<std::ptrdiff_t>(to);
    out.weight.assign(record.weight.begin() + begin, record.weight.begin() + end);
    for (const diagnosis::Channel& channel : record.channels) {
      out.channels.push_back({channel.name,
                              channel.unit,
                              {channel.values.begin() + begin, channel.values.begin() + end}});
    }
    for (const diagnosis::Stretch& stretch : record.stretches) {
      const std::size_t first = std::max(stretch.first, from);
      const std::size_t last = std::min(stretch.end, to);
      if (first >= last) continue;
      const double start_s =
          stretch.start_s + static_cast<double>(first - stretch.first) / record.rate_hz;
      out.stretches.push_back({first - from, last - from, start_s, stretch.recording});
    }
    return out;
  };
  return {part(0, cut), part(cut, record.size())};
}

}  // namespace stillhand::close_the_loop
