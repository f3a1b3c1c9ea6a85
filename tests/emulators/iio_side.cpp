// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/iio_side.hpp"

#include <fcntl.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <utility>

namespace stillhand::emulators {
namespace {

// Formats and scales of the devices: tests/integration/iio_context.py.  The boards' sensitivity:
// rig.yaml.  The bridge's amplifier leaves a fifth.
constexpr double kAccelStep_m_s2 = 3.9e-5;
constexpr double kBoard_v_m_s2 = 0.1019716;
constexpr int kAccelShift = 12;
constexpr std::int32_t kAccelEnd = (1 << 19) - 1;
constexpr double kBridgeStep_v = 2.5e-7;
constexpr double kBridgeGain = 0.2;
constexpr int kBridgeShift = 8;

std::int32_t shifted(double count, int shift) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(std::lround(count)) << shift);
}

}  // namespace

IioSide::IioSide(std::filesystem::path accelerometer, std::filesystem::path bridge)
    : readers_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)),
      accelerometer_{std::move(accelerometer)},
      bridge_{std::move(bridge)} {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that leaves is no reason to end
  watch(accelerometer_);
  watch(bridge_);
}

IioSide::~IioSide() {
  for (const Fifo* fifo : {&accelerometer_, &bridge_}) {
    if (fifo->descriptor >= 0) close(fifo->descriptor);
  }
  close(readers_);
}

void IioSide::watch(Fifo& fifo) const {
  // The folder of iio_context.py: dev/iio:device0, bus/iio/devices/iio:device0.
  fifo.length = fifo.path.parent_path().parent_path() / "bus/iio/devices" / fifo.path.filename() /
                "buffer/length";
  fifo.watch = inotify_add_watch(readers_, fifo.path.c_str(), IN_CLOSE);
}

// A kernel empties its buffer when it is opened again; a FIFO keeps its bytes as long as this side
// has it open.
void IioSide::empty(const Fifo& fifo) {
  const int reader = open(fifo.path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 4096> bytes{};
  while (reader >= 0 && read(reader, bytes.data(), bytes.size()) > 0) {
  }
  if (reader >= 0) close(reader);
}

void IioSide::empty_those_left() {
  alignas(inotify_event) std::array<char, 4096> events{};
  const ssize_t size = read(readers_, events.data(), events.size());
  if (size <= 0) return;
  for (ssize_t at = 0; at < size;) {
    inotify_event event{};
    std::memcpy(&event, events.data() + at, sizeof(event));
    at += static_cast<ssize_t>(sizeof(event) + event.len);
    for (const Fifo* fifo : {&accelerometer_, &bridge_}) {
      if (fifo->watch == event.wd) empty(*fifo);
    }
  }
  // Its own leaving is no event.
  while (read(readers_, events.data(), events.size()) > 0) {
  }
}

// A kernel's buffer has room for as many samples as its reader asked for (libiio 0.24: four
// blocks), and drops the newest ones when it is full (Linux, drivers/iio/buffer/kfifo_buf.c); a
// FIFO would keep 16384.
bool IioSide::is_full(const Fifo& fifo) {
  int waiting = 0;
  if (ioctl(fifo.descriptor, FIONREAD, &waiting) != 0 || waiting == 0) return false;
  std::ifstream file(fifo.length);
  int length = 0;
  return file >> length && waiting >= length * static_cast<int>(sizeof(std::int32_t));
}

void IioSide::put(Fifo& fifo, std::int32_t word) {
  if (fifo.descriptor < 0) {
    fifo.descriptor = open(fifo.path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  }
  if (fifo.descriptor >= 0 && is_full(fifo)) {
    ++counts_.lost;
    return;
  }
  if (fifo.descriptor < 0 || ::write(fifo.descriptor, &word, sizeof(word)) == sizeof(word)) return;
  if (errno == EAGAIN) {
    ++counts_.lost;
    return;
  }
  close(fifo.descriptor);
  fifo.descriptor = -1;
}

void IioSide::write(const rig::RawSample& raw, std::int64_t now_ns) {
  empty_those_left();
  if (starved_) return;
  if (written_ns_ != 0) {
    counts_.longest_gap_ns = std::max(counts_.longest_gap_ns, now_ns - written_ns_);
  }
  written_ns_ = now_ns;
  const double accel = raw.accel_y_v / kBoard_v_m_s2 / kAccelStep_m_s2;
  put(accelerometer_, shifted(saturated_ ? kAccelEnd : accel, kAccelShift));
  put(bridge_, shifted(kBridgeGain * raw.load_cell_v / kBridgeStep_v, kBridgeShift));
}

}  // namespace stillhand::emulators
