// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/recording/core/mcap/mcap_format.hpp"
#include "services/runtime/bus/writer_qos.hpp"

namespace stillhand::recording {

/// A writer's QoS as the texts of its channel (FORMAT.md, "Channel metadata").
TextMap qos_texts(const runtime::WriterQos& qos);

/// Back again; nothing when the texts hold no QoS, as those of other programs.  Unknown words count
/// as the default.
std::optional<runtime::WriterQos> qos_of(const TextMap& texts);

}  // namespace stillhand::recording
