// SPDX-License-Identifier: Apache-2.0
// Model files: each of the three forms; a control model that is read goes on to the canceller's
// check.
#include <string_view>

#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/files/identification/model_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand;
  const std::string_view json(reinterpret_cast<const char*>(bytes), size);
  try {
    identification::parse_model(json, "file");
  } catch (const ConfigError&) {
  }
  try {
    cancellation::Countermeasure({}, {.force = true})
        .load_model(cancellation::parse_control_model(json, "file", 1));
  } catch (const ConfigError&) {
  }
  try {
    diagnosis::parse_carried_model(json, "file");
  } catch (const ConfigError&) {
  }
  try {
    diagnosis::parse_model(json, "file");
  } catch (const ConfigError&) {
  }
  return 0;
}
