// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/stop_key.hpp"

#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "services/core/contract/config_error.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::lab {
namespace {

// A device of evdev with a key, or a pipe with its events.  A plain file ends at once, which would
// be a press; a lid switch or an accelerometer has no key, and would never be pressed.
bool gives_presses(int device) {
  struct stat kind{};
  if (fstat(device, &kind) != 0) return false;
  if (S_ISFIFO(kind.st_mode)) return true;
  std::array<unsigned char, KEY_CNT / 8> keys{};
  return ioctl(device, EVIOCGBIT(EV_KEY, keys.size()), keys.data()) >= 0 &&
         std::ranges::any_of(keys, [](unsigned char bits) { return bits != 0; });
}

}  // namespace

bool KeyPresses::take(std::span<const std::byte> bytes) {
  rest_.insert(rest_.end(), bytes.begin(), bytes.end());
  bool pressed = false;
  std::size_t done = 0;
  for (; rest_.size() - done >= sizeof(input_event); done += sizeof(input_event)) {
    input_event event{};
    std::memcpy(&event, rest_.data() + done, sizeof(event));
    pressed = pressed || (event.type == EV_KEY && event.value == 1);
  }
  rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(done));
  return pressed;
}

StopKey::StopKey(const std::filesystem::path& device, std::function<void()> on_press)
    : device_(open(device.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)),
      on_press_(std::move(on_press)) {
  if (device_ < 0) {
    throw ConfigError(
        "--stop-key",
        device.string() + ", which cannot be opened: " + std::generic_category().message(errno),
        "a device such as /dev/input/event3 that this user may read");
  }
  if (!gives_presses(device_)) {
    close(device_);
    throw ConfigError("--stop-key", device.string() + ", which is no input device with a key",
                      "a device such as /dev/input/event3");
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

StopKey::~StopKey() {
  thread_.request_stop();
  thread_.join();
  close(device_);
}

bool StopKey::wait_for_press(const std::stop_token& stop) const {
  constexpr int kLook_ms = 100;  // for the stop of this thread
  KeyPresses presses;
  std::array<std::byte, 64 * sizeof(input_event)> bytes{};
  while (!stop.stop_requested()) {
    pollfd wait{device_, POLLIN, 0};
    if (poll(&wait, 1, kLook_ms) <= 0) continue;
    const ssize_t count = read(device_, bytes.data(), bytes.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count <= 0) return true;  // unplugged
    if (presses.take(std::span(bytes).first(static_cast<std::size_t>(count)))) return true;
  }
  return false;
}

void StopKey::watch(const std::stop_token& stop) const {
  if (!wait_for_press(stop)) return;
  constexpr int kTimes = 50;
  constexpr std::int64_t kPause_ns = 20'000'000;
  for (int i = 0; i < kTimes && !stop.stop_requested(); ++i) {
    on_press_();
    runtime::sleep_until_ns(runtime::monotonic_ns() + kPause_ns);
  }
}

}  // namespace stillhand::lab
