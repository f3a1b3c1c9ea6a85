// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/schema_types.hpp"

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/messages/ros2msg.hpp"

namespace stillhand::recording {

IdlSchema parse_schema(const Schema& schema, const std::string& source) {
  const std::string_view text(reinterpret_cast<const char*>(schema.bytes.data()),
                              schema.bytes.size());
  IdlSchema types;
  if (schema.encoding == kSchemaEncoding) {
    types = parse_idl(text, source);
  } else if (schema.encoding == kRos2SchemaEncoding) {
    types = parse_ros2msg(text, schema.name, source);
  } else if (schema.encoding.empty()) {
    throw ConfigError(source, "no definition of " + schema.name,
                      "a recording that has it (stillhand record --idl)");
  } else {
    throw ConfigError(source, "a schema in '" + schema.encoding + "'",
                      "a schema in 'omgidl' or 'ros2msg'");
  }
  if (types.find(schema.name) == nullptr) {
    throw ConfigError(source, "no struct " + schema.name, "the type of the messages");
  }
  return types;
}

}  // namespace stillhand::recording
