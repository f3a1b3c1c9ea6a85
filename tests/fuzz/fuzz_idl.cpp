// SPDX-License-Identifier: Apache-2.0
// The definitions inside a recording, and messages of them: the text ends at the first zero, what
// follows is the message of each of its structs.
#include "services/core/contract/config_error.hpp"
#include "tests/fuzz/read_types.hpp"
#include "tests/fuzz/two_parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand;
  const auto [text, message] = fuzz::two_parts(bytes, size);
  try {
    fuzz::read_as_each(recording::parse_idl(text, "file"), std::as_bytes(message));
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
