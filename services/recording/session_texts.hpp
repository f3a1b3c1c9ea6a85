// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "services/recording/core/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// Where and by what a recording is made: host, domain, versions, clocks.  What every metadata
/// record "stillhand.session" holds.
TextMap session_texts(std::uint32_t domain, const std::string& recorded_by);

/// What the stamps of the samples are behind the log times [ns]: system clock less monotonic clock,
/// now.
std::string clock_offset();

}  // namespace stillhand::recording
