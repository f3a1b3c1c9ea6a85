// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/publisher/qos/WriterQos.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fast_dds/names.hpp"
#include "services/bus/writer_qos.hpp"

namespace stillhand::runtime {

/// The QoS of a writer, as announced by discovery.
WriterQos discovered_qos(const edds::WriterQos& announced);

/// Sets what an endpoint offers or accepts; discovery leaves out what is not marked as changed.
void announce(edds::DataRepresentationQosPolicy& policy,
              std::vector<edds::DataRepresentationId_t> offered);

/// A writer that offers the same; resource limits as for KEEP_LAST of its depth.
edds::DataWriterQos offered_qos(const WriterQos& wanted);

/// The QoS of a profile of the loaded file; nothing when it is missing.
std::optional<WriterQos> profile_qos(const edds::Publisher& publisher, const std::string& name);

}  // namespace stillhand::runtime
