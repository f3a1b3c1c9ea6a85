// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "services/core/recording/messages/message_columns.hpp"
#include "services/core/recording/messages/omgidl.hpp"

namespace stillhand::fuzz {

/// Reads the bytes as a message of that type, by its definition, as an export of a recording does.
inline void read_message(const recording::IdlSchema& schema, const recording::IdlStruct& type,
                         std::span<const std::byte> message) {
  recording::MessageColumns columns(schema, type);
  if (!columns.trouble().empty()) return;
  columns.learn(message);
  columns.settle();
  std::vector<recording::Cell> row;
  columns.read(message, row);
}

/// The same bytes as a message of each struct.
inline void read_as_each(const recording::IdlSchema& schema, std::span<const std::byte> message) {
  for (const auto& type : schema.structs) read_message(schema, type, message);
}

}  // namespace stillhand::fuzz
