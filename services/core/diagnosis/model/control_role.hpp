// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "services/core/signal/hysteresis.hpp"

namespace stillhand::diagnosis {

/// What a canceller that runs the model can do about an effect: one struct a law.  A law that needs
/// a function of the signal (a map, a spring) takes it from EffectKind; numbers that EffectKind has
/// no function for are in the struct.
namespace control {

/// The canceller does nothing.
struct LeftOut {
  std::string reason;  ///< one clause for the report, without a full stop
};
/// The hand does not feel the effect: the canceller predicts the force as it is without it.
struct NotFelt {
  std::string reason;  ///< one clause for the report, without a full stop
};
/// The prediction comes as much later as EffectKind::input_delay_s() says.
struct InputDelay {};
/// EffectKind::mapped() of the first channel, before the body.
struct InputMap {};
/// EffectKind::mapped() of the body's force.
struct OutputMap {};
/// EffectKind::feedback() inside the body.
struct Spring {
  std::optional<signal::HysteresisOperator> memory = {};  ///< its phi; none: without memory
};
/// EffectKind::gain() at the end of the recording: of time alone, which the session continues.
struct Gain {};
/// Two poles in addition to the body's; coefficients 2 k and 2 k + 1 are those of input k on the
/// difference of the mode's response and on the response.
struct Mode {
  double frequency_hz;
  double damping_ratio;  ///< [-]
};
/// A linear path from each channel to the force, one coefficient a channel; through the body from
/// the first alone.
struct Path {
  bool through_body;  ///< with the body's poles; otherwise one gain behind a first-order lag
  double lag_s;       ///< 0: none
};
/// Coefficient 0 times an operator with memory of the first channel, and coefficient 1, where there
/// is one, times the channel.
struct Hysteresis {
  signal::HysteresisOperator operation;
  double threshold;  ///< [unit of the channel]
};
/// Sines and cosines of the harmonics of a frequency, coefficients in that order.
struct Waves {
  double frequency;  ///< [Hz]; [1/unit] of the first channel where there is one
};
/// The sign of the first channel, smoothed by tanh(v / transition).
struct Friction {
  double transition;  ///< [unit of the channel] 0: a sharp sign
};

}  // namespace control

using ControlRole =
    std::variant<control::LeftOut, control::NotFelt, control::InputDelay, control::InputMap,
                 control::OutputMap, control::Spring, control::Gain, control::Mode, control::Path,
                 control::Hysteresis, control::Waves, control::Friction>;

}  // namespace stillhand::diagnosis
