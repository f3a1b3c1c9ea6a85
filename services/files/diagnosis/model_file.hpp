// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "services/core/diagnosis/carried.hpp"

namespace stillhand::diagnosis {

/// Newest format of a diagnosed model ("stillhand augmented model" in the file) that this program
/// writes and reads.
/// 2: effects with a share, and the model of a session.  Version 1 is still read.
inline constexpr int kModelFormatVersion = 2;

/// JSON text of a model; README "Model file".  Numbers keep every bit.
std::string model_json(const Model& model);
/// The same with the model that predicts other recordings.
std::string model_json(const Model& found, const CarriedModel& carried);

/// The same with the linear model, for comparison: entry `linear`.
std::string model_json(const Model& found, const CarriedModel& carried, const Model& linear);

/// Reads it back.  @param origin  name of the text in messages, for example its path
/// @throws stillhand::ConfigError naming line and column of a syntax error, or the entry that is
/// missing, has the wrong type or size, is not finite, names an unknown kind, makes the body
/// unstable, or has a newer version.
Model parse_model(std::string_view json, const std::string& origin);

/// The model that predicts other recordings; of a file without one, as older versions wrote them,
/// the model that was found, as it is.  @throws stillhand::ConfigError as parse_model()
CarriedModel parse_carried_model(std::string_view json, const std::string& origin);

/// The linear model; none in a file of an older version.  @throws as parse_model()
std::optional<Model> parse_linear_model(std::string_view json, const std::string& origin);

}  // namespace stillhand::diagnosis
