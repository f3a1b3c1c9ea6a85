// SPDX-License-Identifier: Apache-2.0
// The definitions inside a recording, and messages of them: the text ends at the first zero, what
// follows is the message of each of its structs.
#include <algorithm>
#include <string_view>

#include "services/contract/config_error.hpp"
#include "services/recording/core/messages/message_columns.hpp"
#include "services/recording/core/messages/omgidl.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand;
  const auto* end = std::find(bytes, bytes + size, std::uint8_t{0});
  const std::string_view text(reinterpret_cast<const char*>(bytes),
                              static_cast<std::size_t>(end - bytes));
  const std::span rest(end, bytes + size);
  try {
    const recording::IdlSchema schema = recording::parse_idl(text, "file");
    for (const auto& type : schema.structs) {
      recording::MessageColumns columns(schema, type);
      if (!columns.trouble().empty()) continue;
      columns.learn(std::as_bytes(rest));
      columns.settle();
      std::vector<recording::Cell> row;
      columns.read(std::as_bytes(rest), row);
    }
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
