// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "recording/core/mcap_format.hpp"
#include "runtime/writer_qos.hpp"

namespace stillhand::recording {

/// A writer's QoS as the texts of its channel (FORMAT.md, "Channel metadata").
TextMap qos_texts(const runtime::WriterQos& qos);

/// Back again; nothing when the texts hold no QoS, as those of other programs.  Unknown words count
/// as the default.
std::optional<runtime::WriterQos> qos_of(const TextMap& texts);

}  // namespace stillhand::recording
