// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// Content of the metadata record "stillhand.session": host, domain, versions and clocks.
TextMap session_texts(std::uint32_t domain, const std::string& recorded_by);

/// Present offset of the log times from the stamps of the samples [ns]: system clock minus
/// monotonic clock.
std::string clock_offset();

}  // namespace stillhand::recording
