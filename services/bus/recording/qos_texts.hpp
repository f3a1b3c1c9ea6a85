// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/bus/writer_qos.hpp"
#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// QoS of a writer as metadata of its channel (FORMAT.md, "Channel metadata").
TextMap qos_texts(const runtime::WriterQos& qos);

/// The reverse; nothing if the texts hold no QoS, as in files of other programs.  An unknown word
/// gives the default.
std::optional<runtime::WriterQos> qos_of(const TextMap& texts);

}  // namespace stillhand::recording
