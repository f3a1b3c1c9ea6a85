// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "apps/close_the_loop/recorded/recorded_loop.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::close_the_loop {

/// Adds --pegged and what goes with it to the verb.  @param others  options of a session's run,
/// which have no meaning here
void add_recorded_options(command_line::Command& verb, RecordedOptions& options,
                          const std::vector<command_line::Option>& others);

/// Runs the loop over recordings and writes its files into `out`.
/// @param rig      number of the rig that control_model.json is for
/// @param threads  [-]
void run_recorded(RecordedOptions options, const std::filesystem::path& out, std::uint32_t rig,
                  unsigned threads);

}  // namespace stillhand::close_the_loop
