// SPDX-License-Identifier: Apache-2.0
// Recordings as CSV.  What is read is written and read again: both must agree in size.
#include <cstdlib>
#include <string_view>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/csv.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand;
  try {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    const auto once = recording::to_csv(recording::parse_csv(text, "file"));
    if (recording::to_csv(recording::parse_csv(once, "copy")) != once) std::abort();
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
