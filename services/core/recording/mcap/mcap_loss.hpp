// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/core/recording/mcap/mcap_reader.hpp"

namespace stillhand::recording {

/// One line for a person that states the loss of a recording, or that it is still being written;
/// empty: the recording is whole.  Call it after reading everything.
/// @param path           the file
/// @param damage         the findings of its reader
/// @param messages       [-] delivered messages, if counted
/// @param being_written  a recorder has the file open
std::string loss_line(const std::string& path, const std::vector<Damage>& damage,
                      std::optional<std::uint64_t> messages, bool being_written);
inline std::string loss_line(const std::string& path, const McapReader& reader,
                             std::optional<std::uint64_t> messages, bool being_written) {
  return loss_line(path, reader.damage(), messages, being_written);
}

/// One line for a person that states the steps of a recorder's clock; empty: there are none.
std::string clock_line(const std::string& path, const McapReader& reader);

/// "12 bytes", "3.4 kB", "5.6 MB"
std::string byte_count(std::uint64_t bytes);

}  // namespace stillhand::recording
