// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/diagnosis/model/effect.hpp"

/// Parts of the canceller's model that one effect becomes.
namespace stillhand::close_the_loop {

/// The canceller's channel of this name, if it is given one.
std::optional<cancellation::Channel> channel_of(std::string_view name);

/// The factors of an effect's terms as they act on the force.
std::vector<double> factors_of(const diagnosis::Effect& effect);

/// A map as a table of straight lines from low to high.
cancellation::ValueMap table(double low, double high, const std::function<double(double)>& map);
/// The same from low or less to high or more: of some ways to lay the values, the one that misses
/// least of the map between low and high.  The bends of a map fall on values where they can.
cancellation::ValueMap nearest_table(double low, double high,
                                     const std::function<double(double)>& map);
/// x, held between low and high; of four values.
cancellation::ValueMap held(double low, double high);
/// The map of x held between low and high.
cancellation::ValueMap held_table(double low, double high,
                                  const std::function<double(double)>& map);

/// gain * tanh(rate / transition), the transition wide enough for the encoder's steps.
cancellation::DirectPath friction_path(cancellation::Channel channel, double transition,
                                       double gain);

/// Appends the effect's harmonics of a frequency, times a sign.
/// @param channel  what they are periodic in; none: time
void add_waves(const diagnosis::Effect& effect, std::optional<cancellation::Channel> channel,
               double frequency, double sign, cancellation::ControlModel& model);

}  // namespace stillhand::close_the_loop
