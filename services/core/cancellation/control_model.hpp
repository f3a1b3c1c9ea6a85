// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "services/core/signal/difference_model.hpp"
#include "services/core/signal/hysteresis.hpp"

namespace stillhand::cancellation {

/// Channels of a sensed sample that a model may read.
enum class Channel : std::uint8_t { kAccelX, kAccelY, kAccelZ, kRoll, kTheta, kOmega };

inline constexpr std::size_t kChannels = 6;

struct ChannelFacts {
  std::string_view name;  ///< as in recordings
  std::string_view unit;
  double full_scale;  ///< [unit] largest magnitude that reaches a model
};
/// The sensors' ranges: 1.7 g, a quarter turn of roll, the stick's stop, and a hand's fastest
/// swing.
inline constexpr std::array<ChannelFacts, kChannels> kChannelFacts{{{"a_x", "m/s^2", 16.67},
                                                                    {"a_y", "m/s^2", 16.67},
                                                                    {"a_z", "m/s^2", 16.67},
                                                                    {"roll", "rad", 0.8},
                                                                    {"theta", "rad", 0.6},
                                                                    {"omega", "rad/s", 15.0}}};

/// One tick of them, indexed by Channel.
using ChannelSample = std::array<double, kChannels>;

/// A memoryless map as a table: straight lines between values at even distances from `low` to
/// `high`; the outer lines continue beyond.  Empty: the identity.
struct ValueMap {
  double low = 0.0;
  double high = 0.0;
  std::vector<double> values;
};

/// What drives the body, METHOD Eq. CC-6: a channel, through a map, with its own numerator.
struct InputPath {
  Channel channel = Channel::kAccelY;
  ValueMap map;
  std::vector<double> numerator;  ///< c_0 .. c_p [N a unit of the channel]
};

/// A nonlinear spring inside the body, METHOD Eq. CC-7; by powers of q^-1, each p + 1 long.  With a
/// Hysteresis of its own, phi is over w and may be empty.
struct LoopPath {
  std::vector<double> e;  ///< from phi to the force
  std::vector<double> n;  ///< from the first input to z; empty: z is the body's force
  std::vector<double> m;  ///< from phi to z, the first 0
  ValueMap phi;
  std::int64_t ticks = 1;  ///< from one value of phi to the next: held from each multiple on
};

/// A path next to the body, METHOD Eq. CC-8: gain * map(lag(channel)); with a Hysteresis of its
/// own, gain * map(w(lag(channel))).
struct DirectPath {
  Channel channel = Channel::kAccelX;
  double lag_s = 0.0;  ///< of a first-order lag; 0: none
  ValueMap map;
  double gain = 0.0;  ///< [N a unit of the map]
};

/// An element with memory in front of the map of the spring or of a path, METHOD Eq. CC-19.
struct Hysteresis {
  std::optional<std::size_t> path;  ///< its place in ControlModel::paths; none: the spring's
  signal::HysteresisOperator operation = signal::HysteresisOperator::kStop;
  double threshold = 1.0;  ///< [unit of the argument] above 0
  double low = 0.0;        ///< [unit of the argument], which is held within
  double high = 0.0;       ///< [unit of the argument]
};

/// Periodic in a channel (cogging) or, without one, in time (a tone), METHOD Eq. CC-9.
struct Wave {
  std::optional<Channel> channel;  ///< none: time, tick 0 at 0 s
  double frequency = 0.0;          ///< [1/unit of the channel] or [Hz]
  double sine_n = 0.0;
  double cosine_n = 0.0;
};

/// Compliance of the stick to a force at the hand while tracking, M x'' + B x' + K x = f; the
/// adaptation judges the motion by it, METHOD Eq. CC-10.
struct HandCompliance {
  double mass_kg = 0.0;
  double damping_n_s_m = 0.0;
  double stiffness_n_m = 0.0;
  double lever_m = 0.0;  ///< hand to pivot
};
/// Of the population's mean subject; lever: paper II.
inline constexpr HandCompliance kAverageHand{1.394, 11.18, 1136.0, 0.10};

/// The model that the canceller runs, METHOD Eq. CC-6 to CC-9 and CC-19: the feedthrough force as a
/// function of the sensed channels at the control rate.  A linear body with several inputs, at most
/// one nonlinear spring inside it, and paths and waves next to it; the spring and each path may
/// have a memory. On the bus it is stillhand_msgs::AugmentedModel; its file is control_model.json.
struct ControlModel {
  double rate_hz = 0.0;
  std::vector<double> denominator;  ///< 1, d_1 .. d_p
  std::vector<InputPath> inputs;
  std::optional<LoopPath> loop;
  ValueMap output;  ///< of the body's force
  std::vector<DirectPath> paths;
  std::vector<Wave> waves;
  std::vector<Hysteresis> hysteresis;    ///< at most one for each place
  std::optional<HandCompliance> adapts;  ///< present: gain and phase are followed, Eq. CC-10
};

/// The paper's model: a_y alone.
ControlModel control_model(const signal::DifferenceModel& model);

/// The element with memory of a path, or of the spring; null: it has none.
const Hysteresis* hysteresis_of(const ControlModel& model, std::optional<std::size_t> path);

/// The linear part from one input, as a difference model [N a unit of the channel].
signal::DifferenceModel path_model(const ControlModel& model, const InputPath& input);

}  // namespace stillhand::cancellation
