// SPDX-License-Identifier: Apache-2.0
// What devices send: lines of a drive's adapter, with and without checksums, and packets of both
// platforms.
#include <cstdlib>
#include <string_view>

#include "services/core/device_rig/fdcanusb_line.hpp"
#include "services/core/device_rig/moteus_drive.hpp"
#include "services/core/device_rig/platform_protocol.hpp"

namespace {

using namespace stillhand::device_rig;

void read_drive(std::string_view bytes, bool checked) {
  moteus::LineSplitter lines;
  lines.take(bytes, [&](std::string_view line) {
    const auto received = moteus::read_line(line, checked);
    if (received.kind == moteus::Received::Kind::kFrame) {
      moteus::read_reply(received.frame.payload());
    }
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  read_drive(text, false);
  read_drive(text, true);
  moteus::read_reply({bytes, size});
  plain::read_reply({bytes, size});
  std::uint32_t machine_state = 0;
  moog::read_reply({bytes, size}, machine_state);
  if (machine_state > 0xf) std::abort();
  return 0;
}
