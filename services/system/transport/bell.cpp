// SPDX-License-Identifier: Apache-2.0
#include "services/system/transport/bell.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace stillhand::runtime {

Bell::Bell() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Bell::~Bell() { close(descriptor_); }

void Bell::ring() noexcept {
  // It fails only when it has rung 2^64 - 2 times without being heard.
  [[maybe_unused]] const int refused = eventfd_write(descriptor_, 1);
}

void Bell::wait(int descriptor, int most_ms) noexcept {
  std::array<pollfd, 2> wanted{pollfd{descriptor_, POLLIN, 0}, pollfd{descriptor, POLLIN, 0}};
  poll(wanted.data(), descriptor < 0 ? 1 : 2, most_ms);
  eventfd_t rung = 0;
  [[maybe_unused]] const int none = eventfd_read(descriptor_, &rung);
}

}  // namespace stillhand::runtime
