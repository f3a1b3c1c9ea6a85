// SPDX-License-Identifier: Apache-2.0
#include "services/messages/cancellation/codec.hpp"

#include <algorithm>
#include <cstdint>

namespace stillhand::cancellation {
namespace {

// Of 32 bits on the bus and 8 in the core: a number that is none stays one, and is refused.
std::uint8_t in_8_bits(std::uint32_t number) {
  return static_cast<std::uint8_t>(std::min<std::uint32_t>(number, 255));
}

// Channels of core and bus have one order.
Channel from_idl(stillhand_msgs::ModelChannel channel) {
  return static_cast<Channel>(in_8_bits(static_cast<std::uint32_t>(channel)));
}
stillhand_msgs::ModelChannel to_idl(Channel channel) {
  return static_cast<stillhand_msgs::ModelChannel>(channel);
}
static_assert(static_cast<std::size_t>(stillhand_msgs::MODEL_OMEGA) ==
              static_cast<std::size_t>(Channel::kOmega));

constexpr std::int32_t kOfSpring = -1;

ValueMap from_idl(const stillhand_msgs::ValueMap& map) {
  return {map.low(), map.high(), map.values()};
}
stillhand_msgs::ValueMap to_idl(const ValueMap& map) {
  stillhand_msgs::ValueMap message;
  message.low(map.low);
  message.high(map.high);
  message.values(map.values);
  return message;
}

// Operators of core and bus have one order.  A path that the model does not have is refused.
Hysteresis from_idl(const stillhand_msgs::ModelHysteresis& message) {
  Hysteresis out;
  if (message.path() != kOfSpring) out.path = static_cast<std::size_t>(message.path());
  out.operation = static_cast<signal::HysteresisOperator>(
      in_8_bits(static_cast<std::uint32_t>(message.operation())));
  out.threshold = message.threshold();
  out.low = message.low();
  out.high = message.high();
  return out;
}
stillhand_msgs::ModelHysteresis to_idl(const Hysteresis& hysteresis) {
  stillhand_msgs::ModelHysteresis message;
  message.path(hysteresis.path ? static_cast<std::int32_t>(*hysteresis.path) : kOfSpring);
  message.operation(static_cast<stillhand_msgs::ModelOperator>(hysteresis.operation));
  message.threshold(hysteresis.threshold);
  message.low(hysteresis.low);
  message.high(hysteresis.high);
  return message;
}
static_assert(static_cast<std::size_t>(stillhand_msgs::MODEL_DAHL) ==
              static_cast<std::size_t>(signal::HysteresisOperator::kDahl));

}  // namespace

CountermeasureInput from_idl(const stillhand_msgs::Sensed& sensed, bool enabled, bool permitted) {
  CountermeasureInput input{};
  input.tick = sensed.tick();
  // In Channel's order.
  input.sensed = {sensed.accel_x_m_s2(), sensed.accel_y_m_s2(), sensed.accel_z_m_s2(),
                  sensed.roll_rad(),     sensed.theta_rad(),    sensed.omega_rad_s()};
  input.sensed_flags = sensed.flags();
  input.enabled = enabled;
  input.permitted = permitted;
  return input;
}

Assignment from_idl(const stillhand_msgs::TrialAssignment& message) {
  return {message.trial(), message.cancellation(), !message.parts().empty(),
          needs_force(parts_of(message))};
}

std::vector<Part> parts_of(const stillhand_msgs::TrialAssignment& message) {
  std::vector<Part> parts;
  parts.reserve(message.parts().size());
  // A kind is one number on the bus and in the core.  A number that is no kind stays one, and is
  // refused.
  for (const stillhand_msgs::MitigationPart& part : message.parts()) {
    parts.push_back(
        {static_cast<PartKind>(in_8_bits(static_cast<std::uint32_t>(part.kind()))), part.values()});
  }
  return parts;
}
static_assert(static_cast<std::uint32_t>(stillhand_msgs::PART_NOTCH) ==
              static_cast<std::uint32_t>(PartKind::kNotch));

signal::DifferenceModel from_idl(const stillhand_msgs::FeedthroughModel& message,
                                 const SamplingConfig& sampling) {
  if (sampling.model_ticks > 1) {
    return {message.fit_rate_hz(), message.fit_numerator(), message.fit_denominator()};
  }
  return {message.control_rate_hz(), message.control_numerator(), message.control_denominator()};
}

ControlModel from_idl(const stillhand_msgs::AugmentedModel& message) {
  ControlModel model;
  model.rate_hz = message.rate_hz();
  model.denominator = message.denominator();
  for (const auto& input : message.inputs()) {
    model.inputs.push_back({from_idl(input.channel()), from_idl(input.table()), input.numerator()});
  }
  if (!message.loop().empty()) {
    const auto& loop = message.loop().front();
    model.loop = LoopPath{loop.e(), loop.n(), loop.m(), from_idl(loop.phi())};
    // 0 in a recording from before springs held their value.
    if (message.spring_ticks() != 0) model.loop->ticks = message.spring_ticks();
  }
  model.output = from_idl(message.output());
  for (const auto& path : message.paths()) {
    model.paths.push_back(
        {from_idl(path.channel()), path.lag_s(), from_idl(path.table()), path.gain()});
  }
  for (const auto& wave : message.waves()) {
    Wave& to = model.waves.emplace_back();
    if (wave.channel() != stillhand_msgs::MODEL_TIME) to.channel = from_idl(wave.channel());
    to.frequency = wave.frequency();
    to.sine_n = wave.sine_n();
    to.cosine_n = wave.cosine_n();
  }
  for (const auto& each : message.hysteresis()) model.hysteresis.push_back(from_idl(each));
  if (message.adapts()) {
    model.adapts = HandCompliance{message.hand_mass_kg(), message.hand_damping_n_s_m(),
                                  message.hand_stiffness_n_m(), message.hand_lever_m()};
  }
  return model;
}

stillhand_msgs::AugmentedModel to_idl(const ControlModel& model, std::int32_t number) {
  stillhand_msgs::AugmentedModel message;
  message.model(number);
  message.rate_hz(model.rate_hz);
  message.denominator(model.denominator);
  for (const InputPath& input : model.inputs) {
    auto& to = message.inputs().emplace_back();
    to.channel(to_idl(input.channel));
    to.table(to_idl(input.map));
    to.numerator(input.numerator);
  }
  if (model.loop) {
    auto& to = message.loop().emplace_back();
    to.e(model.loop->e);
    to.n(model.loop->n);
    to.m(model.loop->m);
    to.phi(to_idl(model.loop->phi));
    message.spring_ticks(static_cast<std::int32_t>(model.loop->ticks));
  }
  message.output(to_idl(model.output));
  for (const DirectPath& path : model.paths) {
    auto& to = message.paths().emplace_back();
    to.channel(to_idl(path.channel));
    to.lag_s(path.lag_s);
    to.table(to_idl(path.map));
    to.gain(path.gain);
  }
  for (const Wave& wave : model.waves) {
    auto& to = message.waves().emplace_back();
    to.channel(wave.channel ? to_idl(*wave.channel) : stillhand_msgs::MODEL_TIME);
    to.frequency(wave.frequency);
    to.sine_n(wave.sine_n);
    to.cosine_n(wave.cosine_n);
  }
  for (const Hysteresis& each : model.hysteresis) message.hysteresis().push_back(to_idl(each));
  const HandCompliance hand = model.adapts.value_or(HandCompliance{});
  message.adapts(model.adapts.has_value());
  message.hand_mass_kg(hand.mass_kg);
  message.hand_damping_n_s_m(hand.damping_n_s_m);
  message.hand_stiffness_n_m(hand.stiffness_n_m);
  message.hand_lever_m(hand.lever_m);
  return message;
}

stillhand_msgs::MotorCommand to_idl(const CountermeasureOutput& output,
                                    const CountermeasureInput& input,
                                    const stillhand_msgs::Sensed& sensed, std::int32_t model,
                                    std::int64_t trial) {
  stillhand_msgs::MotorCommand message;
  message.tick(sensed.tick());
  message.acquired_ns(sensed.acquired_ns());
  message.force_n(output.force_n);
  message.predicted_force_n(output.predicted_force_n);
  message.gain_weight(output.weights[0]);
  message.phase_weight(output.weights[1]);
  message.model(model);
  message.enabled(input.enabled);
  message.permitted(input.permitted);
  message.flags(output.flags);
  message.taken_off_rad(output.taken_off_rad);
  message.mitigated_trial(static_cast<std::int32_t>(trial));
  return message;
}

}  // namespace stillhand::cancellation
