// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/core/cancellation/config.hpp"

namespace stillhand::cancellation {

/// Newest "stillhand control model" format that this program writes and reads.
inline constexpr int kModelFormatVersion = 2;

/// JSON text of a model at the control rate, README "Model file".  Numbers keep every bit.
/// @param rig  number of the rig whose hand it was identified on
std::string control_model_json(const ControlModel& model, std::uint32_t rig);

/// Reads it back.  The text sets no limit: require_sound() and the canceller itself decide what a
/// model may ask for.
/// @param origin  name of the text in messages, for example its path
/// @param rig     the rig that the model is for
/// @throws stillhand::ConfigError naming line and column of a syntax error, or the entry that is
/// missing, unknown, has the wrong type or size, isn't finite, another rig or a newer version.
ControlModel parse_control_model(std::string_view json, const std::string& origin,
                                 std::uint32_t rig);

/// @throws stillhand::ConfigError naming `origin` when a canceller with these settings would refuse
/// the model, and why.
void require_sound(const ControlModel& model, const Config& settings, const std::string& origin);

}  // namespace stillhand::cancellation
