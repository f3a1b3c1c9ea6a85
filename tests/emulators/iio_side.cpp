// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/iio_side.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
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
    : accelerometer_{std::move(accelerometer)}, bridge_{std::move(bridge)} {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that leaves is no reason to end
}

IioSide::~IioSide() {
  for (const Fifo* fifo : {&accelerometer_, &bridge_}) {
    if (fifo->descriptor >= 0) close(fifo->descriptor);
  }
}

void IioSide::put(Fifo& fifo, std::int32_t word) {
  if (fifo.descriptor < 0) {
    fifo.descriptor = open(fifo.path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  }
  if (fifo.descriptor < 0 || ::write(fifo.descriptor, &word, sizeof(word)) == sizeof(word)) return;
  if (errno == EAGAIN) return;
  close(fifo.descriptor);
  fifo.descriptor = -1;
}

void IioSide::write(const rig::RawSample& raw) {
  if (starved_) return;
  const double accel = raw.accel_y_v / kBoard_v_m_s2 / kAccelStep_m_s2;
  put(accelerometer_, shifted(saturated_ ? kAccelEnd : accel, kAccelShift));
  put(bridge_, shifted(kBridgeGain * raw.load_cell_v / kBridgeStep_v, kBridgeShift));
}

}  // namespace stillhand::emulators
