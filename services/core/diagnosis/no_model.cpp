// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/no_model.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/before_effects.hpp"
#include "services/core/diagnosis/detection/detection.hpp"
#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/limit.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/record/digits.hpp"
#include "services/core/diagnosis/selection.hpp"
#include "services/core/diagnosis/share_words.hpp"

namespace stillhand::diagnosis {
namespace {

// What time alone leaves of the output, about its mean, in blocks.
HeldOut without_inputs(const Model& model, const Signals& signals, const Blocks& blocks) {
  Model still = model;
  for (auto& numerator : still.body.numerators) std::ranges::fill(numerator, 0.0);
  std::erase_if(still.effects, [](const Effect& effect) {
    const EffectKind& kind = effect_kind(effect.kind);
    return !kind.time_only(effect) || kind.stage(effect) == Stage::kInputTime;
  });
  FreeRun run;
  const Eigen::VectorXd residual = residual_of(still, signals, run);
  double mean = 0.0;
  double weights = 0.0;
  for (std::size_t n = 0; n < signals.size(); ++n) {
    if (!(run.weight[n] > 0.0)) continue;
    weights += run.weight[n];
    mean += (residual[static_cast<Eigen::Index>(n)] - mean) * run.weight[n] / weights;
  }
  HeldOut out{run.finite, std::vector<double>(blocks.count, 0.0),
              std::vector<double>(blocks.count, 0.0)};
  for (std::size_t n = 0; n < signals.size(); ++n) {
    const double each = residual[static_cast<Eigen::Index>(n)] - mean;
    const std::size_t block = std::min(n / blocks.length, blocks.count - 1);
    if (run.weight[n] > 0.0) out.squares[block] += run.weight[n] * each * each;
    out.weights[block] += run.weight[n];
  }
  return out;
}

// A linear model, and what it leaves [-] of the output's square, held out.
struct Linear {
  Model model;
  double left = 1.0;
};

// None where none can be fitted.
std::optional<Linear> linear_of(const Signals& signals, int order) {
  try {
    const Blocks blocks = make_blocks(signals);
    Baseline baseline = fit_baseline(signals, blocks, order);
    const double error =
        held_out(baseline.model, signals, blocks).rmse() / signals.output().deviation;
    return Linear{std::move(baseline.model), error * error};
  } catch (const ConfigError&) {
    return {};
  }
}

double left_by_linear(const Signals& signals, int order) {
  const std::optional<Linear> linear = linear_of(signals, order);
  return linear ? linear->left : 1.0;
}

// Folds in one piece each: blocks between others share a narrow band's phase with them.
Blocks in_parts(Blocks blocks) {
  blocks.fold.resize(blocks.count);
  for (std::size_t b = 0; b < blocks.count; ++b) blocks.fold[b] = b * blocks.folds / blocks.count;
  return blocks;
}

// [-] of the output's square; with half of it explained, chance is no question.
constexpr double kClearlyLess = 0.5;
// [-] of the squared error that another reading of the recording must leave at most.
constexpr double kBetterReading = 0.5;

std::string percent(double left) { return share_in_words(1.0 - left); }

Measurement one_recording(const Measurement& all, std::size_t number) {
  Measurement out;
  out.source = all.source;
  out.rate_hz = all.rate_hz;
  for (const Channel& channel : all.channels)
    out.channels.push_back({channel.name, channel.unit, {}});
  for (Stretch stretch : all.stretches) {
    if (stretch.recording != number) continue;
    const auto cut = [&](const std::vector<double>& from, std::vector<double>& to) {
      const auto begin = from.begin();
      to.insert(to.end(), begin + static_cast<std::ptrdiff_t>(stretch.first),
                begin + static_cast<std::ptrdiff_t>(stretch.end));
    };
    const std::size_t first = out.weight.size();
    for (std::size_t c = 0; c < all.channels.size(); ++c) {
      cut(all.channels[c].values, out.channels[c].values);
    }
    cut(all.weight, out.weight);
    out.stretches.push_back({first, out.weight.size(), stretch.start_s});
  }
  return out;
}

class OtherReadings {
 public:
  OtherReadings(const Measurement& measurement, const Signals& signals, double left, int order)
      : measurement_(measurement), signals_(signals), left_(left), order_(order) {}

  // A force that holds more than its input causes explains it well too, by leaving the rest out:
  // only where the inputs explain nothing, or their future explains far more.
  [[nodiscard]] std::optional<NoModel> swapped(double most = kBetterReading) const {
    if (signals_.inputs().size() != 1) return {};
    const std::string& input = signals_.inputs().front().name;
    const double left = left_by_linear({measurement_, {signals_.output().name}, input}, order_);
    if (!(left < most * left_)) return {};
    return NoModel{"swapped",
                   swapped_in_words(input, 1.0 - left, signals_.output().name, 1.0 - left_)};
  }

  // Eq. DG-81.
  [[nodiscard]] std::optional<NoModel> leads() const {
    if (left_ < kLeadGate || signals_.inputs().size() != 1) return {};
    for (const double lead_s : kLeads_s) {
      const Signals shifted = signals_.moved([&](const Signal& signal) {
        return diagnosis::moved(signal.values, signals_.rate_hz(), {-lead_s, 0.0, 0.0});
      });
      const double left = left_by_linear(shifted, order_);
      if (!(left < kBetterLead * left_)) continue;
      if (auto other = swapped()) return other;
      return NoModel{"clocks", lead_in_words(signals_.inputs().front().name, signals_.output().name,
                                             lead_s, left, left_)};
    }
    return {};
  }

  // @param drifting  a lag that grows too, which `clock_drift` may describe
  [[nodiscard]] std::optional<NoModel> clocks(bool drifting) const {
    const Alignment alignment =
        aligned(signals_.inputs().front().values, signals_.output().values, signals_.rate_hz());
    if (!drifting && drifts(alignment)) return {};
    double least = left_;
    Alignment best;
    for (const Alignment& each : readings(alignment)) {
      const Signals shifted = signals_.moved([&](const Signal& signal) {
        return diagnosis::moved(signal.values, signals_.rate_hz(), each);
      });
      const double left = left_by_linear(shifted, order_);
      if (left >= least) continue;
      least = left;
      best = each;
    }
    if (!(least < kBetterClock * left_)) return {};
    return NoModel{"clocks", in_words(best) + "; corrected by that, a linear model explains " +
                                 percent(least) + " instead of " + percent(left_)};
  }

  // Several recordings, each with a model of its own, which differ in sign or by a unit.  An effect
  // can describe that, as a change of regime between two of them, and is none.
  [[nodiscard]] std::optional<NoModel> one_of_several() const {
    const std::size_t count = measurement_.stretches.back().recording + 1;
    if (count < 2) return {};
    const double together = left_by_linear(signals_, order_);
    if (together < kAlignmentGate) return {};
    std::optional<Model> first;
    std::optional<NoModel> out;
    std::vector<std::string> inputs;
    for (const Signal& input : signals_.inputs()) inputs.push_back(input.name);
    for (std::size_t r = 0; r < count; ++r) {
      const Measurement part = one_recording(measurement_, r);
      if (part.size() == 0) return {};
      const Signals signals(part, inputs, signals_.output().name);
      std::optional<Linear> own = linear_of(signals, order_);
      if (!own || !(own->left < kBetterReading * together)) return {};
      if (!first) {
        first = std::move(own->model);
      } else if (!out) {
        out = compared_with(*first, signals, r);
      }
    }
    return out;
  }

 private:
  static std::optional<NoModel> compared_with(const Model& first, const Signals& signals,
                                              std::size_t number) {
    const auto [gain, share] =
        likeness(free_run(first, signals).prediction, signals.output().values);
    if (share < kClearlyLess) return {};
    const std::string which = "recording " + std::to_string(number + 1) + " has ";
    if (gain < 0.0) {
      return NoModel{"sign", which + "the other sign than recording 1: its gain is " +
                                 digits(gain, 3) + " times that one's"};
    }
    if (gain > kAnotherUnit || gain < 1.0 / kAnotherUnit) {
      return NoModel{"unit", which + digits(gain, 3) +
                                 " times the gain of recording 1: one of their units is wrong"};
    }
    return {};
  }

  const Measurement& measurement_;
  const Signals& signals_;
  double left_;
  int order_;
};

// What a model leaves of the output: [-] of what time alone leaves of it, and that [its unit].
struct Rest {
  double left = 1.0;
  double still_rmse = 0.0;
};

Rest rest_of(const Signals& signals, const Blocks& blocks, const Model& model, double error) {
  const double still = without_inputs(model, signals, blocks).rmse();
  return {std::pow(error / std::max(still, 1e-300), 2.0), still};
}

// Eq. DG-80.
std::string mass_of(const Signals& signals, const Rest& rest, double heaviest_kg) {
  if (signals.inputs().size() != 1 || rest.left > 1.0) return {};
  const Signal& input = signals.inputs().front();
  const Signal& output = signals.output();
  return unlikely_mass({input.name, input.unit, input.deviation, output.name, output.unit,
                        std::sqrt(1.0 - rest.left) * rest.still_rmse, heaviest_kg});
}

// Eq. DG-87, in the longest stretch.
std::string limit_of_input(const Signals& signals) {
  if (signals.inputs().size() != 1) return {};
  const auto length = [](const Stretch& each) { return each.end - each.first; };
  const Stretch& longest = std::ranges::max(signals.stretches(), {}, length);
  const auto part = [&](const Signal& signal) {
    const auto begin = signal.values.begin();
    return std::vector<double>(begin + static_cast<std::ptrdiff_t>(longest.first),
                               begin + static_cast<std::ptrdiff_t>(longest.end));
  };
  const Signal& input = signals.inputs().front();
  return limit_in_words(input.name, part(input), signals.output().name, part(signals.output()),
                        signals.rate_hz());
}

}  // namespace

std::optional<NoModel> before_any_fit(const Measurement& measurement,
                                      const std::vector<std::string>& inputs,
                                      const std::string& output) {
  std::vector<std::string> channels = inputs;
  channels.push_back(output);
  if (std::string why = why_unsound(measurement, channels); !why.empty()) {
    return NoModel{"samples", std::move(why)};
  }
  const Channel* y = measurement.find(output);
  for (const std::string& input : inputs) {
    const Channel* x = measurement.find(input);
    if (x == nullptr || y == nullptr) return {};  // named where the signals are made
    std::string why = one_sensor_twice(input, x->values, output, y->values);
    if (!why.empty()) return NoModel{"copy", std::move(why)};
  }
  return {};
}

std::optional<NoModel> exchanged_of(const Measurement& measurement, const Signals& signals,
                                    const Blocks& blocks, const Model& baseline, int order,
                                    double heaviest_kg) {
  const Rest rest = rest_of(signals, blocks, baseline, held_out(baseline, signals, blocks).rmse());
  const OtherReadings others(measurement, signals, rest.left, order);
  if (auto early = others.leads()) return early;
  return mass_of(signals, rest, heaviest_kg).empty() ? std::nullopt : others.swapped(kBetterLead);
}

std::optional<NoModel> late_of(const Measurement& measurement, const Signals& signals,
                               const Blocks& blocks, const Model& baseline, int order) {
  const Rest rest = rest_of(signals, blocks, baseline, held_out(baseline, signals, blocks).rmse());
  if (rest.left < kAlignmentGate) return {};
  return OtherReadings(measurement, signals, rest.left, order).clocks(false);
}

std::optional<NoModel> no_model_of(const Measurement& measurement, const Signals& signals,
                                   const Blocks& blocks, const Model& model, double heldout_rmse,
                                   int order, double heaviest_kg) {
  const HeldOut still = without_inputs(model, signals, blocks);
  const Rest rest = rest_of(signals, blocks, model, heldout_rmse);
  const double left = rest.left;
  if (left < kClearlyLess) {
    std::string why = mass_of(signals, rest, heaviest_kg);
    if (!why.empty()) return NoModel{"unit", std::move(why)};
  }
  if (left > kMostClipped * kMostClipped) {
    if (std::string why = limit_of_input(signals); !why.empty()) {
      return NoModel{"samples", std::move(why)};
    }
  }
  const OtherReadings others(measurement, signals, left, order);
  if (auto other = others.one_of_several()) return other;
  if (left < kAlignmentGate) return {};
  if (auto other = others.clocks(true)) return other;
  if (left < kClearlyLess) return {};
  const HeldOut apart = held_out(model, signals, in_parts(blocks));
  const double left_apart = std::pow(apart.rmse() / std::max(still.rmse(), 1e-300), 2.0);
  if (left_apart < 1.0 - kLeastShare && compared(still, apart).p < kSignificance) return {};
  if (auto swapped = others.swapped()) return swapped;
  std::string inputs;
  for (const Signal& input : signals.inputs()) inputs += (inputs.empty() ? "" : ", ") + input.name;
  return NoModel{"unrelated", inputs + " explains " + percent(left_apart) + " of " +
                                  signals.output().name +
                                  " on parts that the fit has not seen, and no lag, clock or swap "
                                  "of columns explains more: these channels don't belong together, "
                                  "or no effect that is known here joins them"};
}

}  // namespace stillhand::diagnosis
