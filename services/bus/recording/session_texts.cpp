// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/session_texts.hpp"

#include <unistd.h>

#include "services/system/process/clock.hpp"
#include "version.hpp"

namespace stillhand::recording {
std::string clock_offset() {
  return std::to_string(runtime::system_ns() - runtime::monotonic_ns());
}

TextMap session_texts(std::uint32_t domain, const std::string& recorded_by) {
  char host[256] = {};
  if (gethostname(host, sizeof(host) - 1) != 0) host[0] = '\0';
  return {{"host", host},
          {"domain", std::to_string(domain)},
          {"stillhand", kVersion},
          {"git", STILLHAND_GIT},
          {"recorded_by", recorded_by},
          {"log_clock", "monotonic"},
          {"clock_offset_ns at start", clock_offset()}};
}

}  // namespace stillhand::recording
