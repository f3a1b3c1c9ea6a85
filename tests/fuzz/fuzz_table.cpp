// SPDX-License-Identifier: Apache-2.0
// Text tables of other programs: the mapping is the text up to the first zero, the table follows.
// A mapping that is read is written and read again: both texts must be the same.
#include <cstdlib>
#include <string>

#include "apps/libraries/measurement/grid.hpp"
#include "apps/libraries/measurement/tables/apply_mapping.hpp"
#include "apps/libraries/measurement/tables/text_table.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/fuzz/two_parts.hpp"

namespace {

using namespace stillhand;

constexpr std::size_t kMostValues = 1'000'000;

measurement::Mapping checked(const std::string& yaml) {
  const auto mapping = measurement::parse_mapping(yaml, "mapping.yaml");
  const std::string once = measurement::mapping_yaml(mapping, "table");
  try {
    const auto again = measurement::parse_mapping(once, "copy");
    if (measurement::mapping_yaml(again, "table") != once) std::abort();
  } catch (const ConfigError&) {
    std::abort();
  }
  return mapping;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto [yaml, rest] = fuzz::two_parts(bytes, size);
  if (rest.empty()) return 0;
  try {
    const auto mapping = checked(std::string(yaml));
    const std::string table(reinterpret_cast<const char*>(rest.data()) + 1, rest.size() - 1);
    const auto file = measurement::text_table(measurement::to_utf8(table, "table"), "table",
                                              mapping.form, kMostValues);
    measurement::on_grid(measurement::apply_mapping(*file, mapping).rows, kMostValues);
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
