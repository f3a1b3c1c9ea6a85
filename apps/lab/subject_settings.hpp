// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

namespace stillhand::lab {

/// Writes the settings of a session with a drawn subject: every file of `config`, in which rig and
/// operator have the drawn quantities of that subject and the learnt feel of the rig's stick.
/// @param config   folder of the services' settings
/// @param to       folder that gets them; it is made
/// @param seed     of the draw, Eq. SU-1; `stillhand study --seed` draws the same person with it
/// @param subject  number of the subject, from 1 on
/// @throws ConfigError for a file of `config` that is wrong; std::runtime_error if `to` cannot be
///         written
void write_subject_settings(const std::filesystem::path& config, const std::filesystem::path& to,
                            std::uint64_t seed, std::int64_t subject);

/// Copies the settings, with a target that stands still, and a simulated body that does this
/// (population::task_from) with the stick.
/// @param to  may be `config` itself
void write_perturbed_settings(const std::filesystem::path& config, const std::filesystem::path& to,
                              const std::string& task);

}  // namespace stillhand::lab
