// SPDX-License-Identifier: Apache-2.0
#include "services/system/transport/serial_port.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why, const std::string& want) {
  throw ConfigError("serial port " + path, why, want);
}

void make_raw(int descriptor, const std::string& path) {
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) refuse(path, "no terminal", "a serial port");
  cfmakeraw(&settings);
  // A UART's; a USB adapter's own and a pseudo-terminal ignore it.
  cfsetspeed(&settings, B921600);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cc[VMIN] =
      1;  // nothing there reads as EAGAIN, and 0 means that the other side is gone
  settings.c_cc[VTIME] = 0;
  if (tcsetattr(descriptor, TCSANOW, &settings) != 0)
    refuse(path, std::generic_category().message(errno), "a serial port");
}

}  // namespace

SerialPort::SerialPort(const std::string& path) {
  descriptor_ = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) {
    refuse(path, std::generic_category().message(errno),
           "a port that this user may read and write");
  }
  try {
    // Two processes that command one drive would be two sources of force.
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      refuse(path, "a port that another process has", "a port for this session alone");
    }
    make_raw(descriptor_, path);
    ioctl(descriptor_, TIOCEXCL);
    tcflush(descriptor_, TCIOFLUSH);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

SerialPort::~SerialPort() {
  ioctl(descriptor_, TIOCNXCL);
  close(descriptor_);
}

std::string_view SerialPort::read(std::span<char> into) noexcept {
  const ssize_t count = ::read(descriptor_, into.data(), into.size());
  if (count > 0) return {into.data(), static_cast<std::size_t>(count)};
  if (count == 0 || (errno != EAGAIN && errno != EINTR)) gone_ = true;
  return {};
}

bool SerialPort::write(std::string_view text) noexcept {
  const ssize_t count = ::write(descriptor_, text.data(), text.size());
  if (count < 0 && errno != EAGAIN && errno != EINTR) gone_ = true;
  return count == static_cast<ssize_t>(text.size());
}

}  // namespace stillhand::runtime
