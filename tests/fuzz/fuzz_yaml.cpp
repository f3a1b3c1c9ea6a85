// SPDX-License-Identifier: Apache-2.0
// Settings as YAML.
#include <string>

#include "services/core/cancellation/config.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/population/population.hpp"
#include "services/core/rig/rig.hpp"
#include "services/files/settings/load.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand;
  if (size == 0) return 0;
  const std::string yaml(reinterpret_cast<const char*>(bytes), size);
  try {
    // All three: a key that one does not know is its message.
    settings::load_text<rig::RigConfig>(yaml, "rig");
  } catch (const ConfigError&) {
  }
  try {
    settings::load_text<cancellation::Config>(yaml, "cancellation");
  } catch (const ConfigError&) {
  }
  try {
    settings::load_text<population::Population>(yaml, "population");
  } catch (const ConfigError&) {
  }
  return 0;
}
