// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fastdds/dds/publisher/qos/WriterQos.hpp>
#include <string>
#include <vector>

#include "fast_dds/names.hpp"

namespace stillhand::runtime {

/// A participant of which discovery brings something new.
struct AnnouncedParticipant {
  ertps::GuidPrefix_t prefix;
  std::string name;
  std::vector<std::uint8_t> user_data;
  bool here = true;  ///< false: it left
};

/// The same of a writer.
struct AnnouncedWriter {
  ertps::GUID_t guid;
  std::string topic;
  std::string type;  ///< DDS type name
  edds::WriterQos qos;
  bool here = true;
  std::string idl = {};  ///< definition of the type, if discovery describes it
};

}  // namespace stillhand::runtime
