// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/seen_range.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr const char* kArgument = "argument";

SeenRange range_of(std::string of, std::string unit, const std::vector<double>& values,
                   const std::vector<double>& weight) {
  SeenRange range{std::move(of), std::move(unit), HUGE_VAL, -HUGE_VAL};
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (weight[n] <= 0.0) continue;
    range.low = std::min(range.low, values[n]);
    range.high = std::max(range.high, values[n]);
  }
  if (range.low > range.high) range.low = range.high = 0.0;
  return range;
}

// What each range of an effect is the range of, in their order; `map` counts the output maps.
std::vector<const std::vector<double>*> read_by(const Effect& effect, const Signals& signals,
                                                const FreeRun& run, std::size_t& map) {
  switch (effect_kind(effect.kind).stage(effect)) {
    case Stage::kTerm:
    case Stage::kGain: {
      std::vector<const std::vector<double>*> all;
      for (const std::string& channel : effect.channels) {
        all.push_back(&signals.at(channel).values);
      }
      return all;
    }
    case Stage::kInputValue:
      return {&signals.at(effect.channels.at(0)).values};
    case Stage::kFeedback:
      return {&run.argument};
    case Stage::kOutputValue:
      return {&run.unmapped.at(map++)};
    case Stage::kInputTime:
    case Stage::kWeight:
      break;
  }
  return {};
}

// Everywhere: such an effect is as it was fitted, and its output map's argument is kept.
std::vector<SeenRange> everywhere(const Effect& effect, const Model& model,
                                  const Signals& signals) {
  const Stage stage = effect_kind(effect.kind).stage(effect);
  std::vector<SeenRange> ranges;
  if (stage == Stage::kTerm || stage == Stage::kGain) {
    for (const std::string& channel : effect.channels) {
      ranges.push_back({channel, signals.at(channel).unit, -HUGE_VAL, HUGE_VAL});
    }
  } else if (stage == Stage::kInputValue) {
    const std::string& unit = signals.at(effect.channels.at(0)).unit;
    ranges.push_back({kArgument, unit, -HUGE_VAL, HUGE_VAL});
  } else if (stage == Stage::kOutputValue) {
    ranges.push_back({kArgument, model.output_unit, -HUGE_VAL, HUGE_VAL});
  } else if (stage == Stage::kFeedback) {
    ranges.push_back({kArgument, "", -HUGE_VAL, HUGE_VAL});
  }
  return ranges;
}

}  // namespace

void note_seen(Model& model, const Signals& signals) {
  for (Effect& effect : model.effects) effect.seen = everywhere(effect, model, signals);
  const FreeRun run = free_run(model, signals);
  std::size_t map = 0;
  for (Effect& effect : model.effects) {
    const auto read = read_by(effect, signals, run, map);
    for (std::size_t i = 0; i < effect.seen.size(); ++i) {
      SeenRange& range = effect.seen[i];
      range = range_of(range.of, range.unit, *read.at(i), run.weight);
    }
  }
}

std::vector<SeenRange> input_ranges(const Signals& signals) {
  std::vector<SeenRange> ranges;
  for (const Signal& input : signals.inputs()) {
    ranges.push_back(range_of(input.name, input.unit, input.values, signals.weight()));
  }
  return ranges;
}

std::vector<LeftRange> left_ranges(const Model& model, const std::vector<SeenRange>& inputs,
                                   const Signals& signals, const FreeRun& run) {
  std::vector<LeftRange> left;
  const auto ask = [&](const std::string& effect, const SeenRange& range,
                       const std::vector<double>& values) {
    double outside = 0.0;
    double all = 0.0;
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (run.weight[n] <= 0.0) continue;
      all += 1.0;
      if (!range.holds(values[n])) outside += 1.0;
    }
    if (outside > 0.0) left.push_back({effect, range, outside / all});
  };
  for (const SeenRange& range : inputs) ask("", range, signals.at(range.of).values);
  std::size_t map = 0;
  for (const Effect& effect : model.effects) {
    if (effect.seen.empty()) continue;
    const auto read = read_by(effect, signals, run, map);
    for (std::size_t i = 0; i < std::min(read.size(), effect.seen.size()); ++i) {
      ask(effect.kind, effect.seen[i], *read[i]);
    }
  }
  return left;
}

}  // namespace stillhand::diagnosis
