// SPDX-License-Identifier: Apache-2.0
// No sequence of samples, models, permissions and ticks drives the canceller's force beyond its
// limits, or keeps it up once something forbids it.  A failure prints seed, step and the shortest
// sequence that was found.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <memory>
#include <numbers>
#include <ostream>

#include "services/core/cancellation/model_check.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "tests/support/hostile.hpp"

namespace stillhand::cancellation::countermeasure_property_test {
namespace {

using support::Broken;
using support::Hostile;

constexpr std::uint64_t kSequences = 400;
constexpr std::size_t kSequenceSteps = 2500;

struct PropertyStep {
  CountermeasureInput input;
  std::shared_ptr<const ControlModel> model;  ///< comes before the sample; none: no model

  friend std::ostream& operator<<(std::ostream& out, const PropertyStep& step) {
    if (step.model) out << "model of " << step.model->inputs.size() << " inputs, ";
    out << "tick " << step.input.tick << " sensed";
    for (const double value : step.input.sensed) out << ' ' << value;
    return out << " flags " << step.input.sensed_flags << (step.input.enabled ? " enabled" : "")
               << (step.input.permitted ? " permitted" : "");
  }
};

// Denominator from conjugate pole pairs; some lie on or outside the unit circle.
std::vector<double> denominator_of(Hostile& draw, std::size_t pairs) {
  std::vector<double> out{1.0};
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    const double radius = draw.chance(0.1) ? draw.uniform(0.99, 1.02) : draw.uniform(0.0, 0.995);
    const double angle = draw.uniform(0.0, std::numbers::pi);
    const std::array<double, 3> factor{1.0, -2.0 * radius * std::cos(angle), radius * radius};
    std::vector<double> product(out.size() + 2, 0.0);
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (std::size_t j = 0; j < factor.size(); ++j) product[i + j] += out[i] * factor[j];
    }
    out = product;
  }
  return out;
}

ControlModel model_of(Hostile& draw) {
  ControlModel model;
  model.rate_hz = draw.worst() ? draw.number(1000.0) : 1000.0;
  model.denominator = denominator_of(draw, draw.index(4));
  const std::size_t taps = model.denominator.size();
  const std::size_t inputs = draw.chance(0.7) ? 1 : 1 + draw.index(3);
  for (std::size_t i = 0; i < inputs; ++i) {
    InputPath path;
    path.channel = i == 0 ? Channel::kAccelY : static_cast<Channel>(draw.index(kChannels));
    const double scale = std::pow(10.0, draw.uniform(-2.0, 2.0));
    for (std::size_t tap = 0; tap < taps; ++tap) path.numerator.push_back(draw.number(scale));
    model.inputs.push_back(path);
  }
  if (draw.chance(0.2)) {
    model.paths.push_back({static_cast<Channel>(draw.index(kChannels)),
                           std::abs(draw.number(0.1)),
                           {-1.0, 1.0, {-1.0, draw.number(1.0), 1.0}},
                           draw.number(5.0)});
  }
  if (draw.chance(0.2)) {
    model.waves.push_back({std::nullopt, std::abs(draw.number(20.0)), draw.number(3.0), 1.0});
  }
  if (draw.chance(0.3)) model.adapts = HandCompliance{1.5, draw.uniform(5.0, 60.0), 900.0, 0.1};
  return model;
}

// Almost always a model that is taken: without one there is no force to watch.
std::shared_ptr<const ControlModel> pure_gain(Hostile& draw) {
  ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0};
  model.inputs = {{Channel::kAccelY, {}, {draw.uniform(-50.0, 50.0)}}};
  return std::make_shared<ControlModel>(model);
}

std::vector<PropertyStep> steps_of(std::uint64_t seed) {
  Hostile draw(seed);
  std::vector<PropertyStep> steps(kSequenceSteps);
  Tick tick = 0;
  bool enabled = true;
  bool permitted = true;
  double level_m_s2 = draw.uniform(-15.0, 15.0);
  for (std::size_t n = 0; n < kSequenceSteps; ++n) {
    if (draw.chance(0.005)) enabled = !enabled;
    if (draw.chance(0.005)) permitted = !permitted;
    if (draw.chance(0.01)) level_m_s2 = draw.uniform(-15.0, 15.0);
    PropertyStep& step = steps[n];
    step.input = {draw.tick(tick), {}, kGood, enabled, permitted};
    for (double& value : step.input.sensed) value = draw.number(0.5);
    if (!draw.worst()) step.input.sensed[1] = level_m_s2;
    if (draw.worst()) step.input.sensed_flags = Flags{1} << draw.index(32);
    if (n == 0 || draw.chance(0.002)) {
      step.model =
          draw.chance(0.5) ? pure_gain(draw) : std::make_shared<ControlModel>(model_of(draw));
    }
    // Mostly the sample clock goes on from where it is, wherever that is.
    tick = step.input.tick < std::numeric_limits<Tick>::max() && draw.chance(0.5)
               ? step.input.tick + 1
               : support::moved(tick, 1);
  }
  return steps;
}

Config config_of(std::uint64_t seed) {
  Hostile draw(seed ^ 0x5eedu);
  Config config;
  if (seed % 2 == 0) return config;
  config.limits = {draw.uniform(0.0, 60.0), draw.uniform(1.0, 20'000.0),
                   static_cast<std::int64_t>(1 + draw.index(50))};
  config.gain = draw.uniform(0.0, 1.2);
  config.fade_ticks = static_cast<std::int64_t>(50 + draw.index(300));
  config.max_hold_ticks = static_cast<std::int64_t>(1 + draw.index(200));
  return config;
}

bool sound(const CountermeasureInput& input, const Config& config) {
  return std::ranges::all_of(input.sensed, [](double value) { return std::isfinite(value); }) &&
         std::abs(input.sensed[1]) <= config.max_acceleration_m_s2 &&
         (input.sensed_flags & (kInputInvalid | kInputStale | kFault)) == 0;
}

struct Watched {
  std::optional<Broken> broken;
  double largest_n = 0.0;
};

Watched watched(const Config& config, const std::vector<PropertyStep>& steps) {
  Countermeasure sut(config, {.force = true});
  support::ForceWatch watch(config.limits.max_force_n, config.limits.max_slew_n_s,
                            config.limits.ramp_ticks);
  bool has_model = false;
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const PropertyStep& step = steps[n];
    if (step.model && sut.load_model(*step.model) == Refusal::kNone) has_model = true;
    const CountermeasureOutput out = sut.step(step.input);
    const bool allowed =
        step.input.enabled && step.input.permitted && has_model && sound(step.input, config);
    if (auto what = watch.see(out.force_n, allowed)) return {Broken{n, *what}, watch.largest_n()};
    if (!std::isfinite(out.predicted_force_n)) return {Broken{n, "prediction is not finite"}, 0.0};
  }
  return {std::nullopt, watch.largest_n()};
}

TEST(CountermeasurePropertyTest, NoSequenceDrivesTheForceBeyondForceSlewOrDuration) {
  int at_limit = 0;
  for (std::uint64_t seed = 1; seed <= kSequences; ++seed) {
    const Config config = config_of(seed);
    const auto steps = steps_of(seed);
    const Watched seen = watched(config, steps);
    ASSERT_FALSE(seen.broken.has_value()) << support::failure_of<PropertyStep>(
        seed, steps, [&](const auto& part) { return watched(config, part).broken; });
    if (seen.largest_n == config.limits.max_force_n) ++at_limit;
  }
  // Sequences without a force would show nothing.
  EXPECT_GT(at_limit, static_cast<int>(kSequences) / 4);
}

// METHOD Eq. CC-14.  The scan has 400 frequencies and each pole's own.  Between them a response can
// be higher by what it bends over half a step of the scan, (1.25 Hz)^2 / 2 of its second
// derivative; a resonance narrower than that is judged at its pole.  5 % covers both.
TEST(CountermeasurePropertyTest, NoModelThatIsTakenAnswersAnyFrequencyWithMoreThanItsBound) {
  const Config config;
  int taken = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    Hostile draw(seed);
    const ControlModel model = model_of(draw);
    if (check_model(model, bounds(config)).refusal != Refusal::kNone) continue;
    ++taken;
    const auto first = path_model(model, model.inputs[0]);
    for (const auto& pole : signal::poles(first)) ASSERT_LT(std::abs(pole), 1.0) << seed;
    for (int n = 0; n < 100; ++n) {
      const double frequency_hz = draw.uniform(0.0, 500.0);
      ASSERT_LE(std::abs(signal::response_at(first, frequency_hz)),
                1.05 * config.max_model_gain_n_s2_m)
          << "seed " << seed << ", " << frequency_hz << " Hz";
    }
  }
  EXPECT_GT(taken, 300);
}

}  // namespace
}  // namespace stillhand::cancellation::countermeasure_property_test
