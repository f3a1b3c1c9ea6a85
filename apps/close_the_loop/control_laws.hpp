// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "services/cancellation/core/control_model.hpp"
#include "services/diagnosis/core/model/effect.hpp"

/// Parts of the canceller's model that one effect becomes.
namespace stillhand::close_the_loop {

/// The canceller's channel of this name, if it is given one.
std::optional<cancellation::Channel> channel_of(std::string_view name);

/// A map as a table of straight lines from low to high.
cancellation::ValueMap table(double low, double high, const std::function<double(double)>& map);

/// gain * tanh(rate / transition), the transition wide enough for the encoder's steps.
cancellation::DirectPath friction_path(cancellation::Channel channel, double transition,
                                       double gain);

/// Appends the effect's harmonics of a frequency, times a sign.
/// @param channel  what they are periodic in; none: time
void add_waves(const diagnosis::Effect& effect, std::optional<cancellation::Channel> channel,
               double frequency, double sign, cancellation::ControlModel& model);

}  // namespace stillhand::close_the_loop
