// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/iio_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "services/core/contract/units.hpp"
#include "services/core/device_rig/iio_value.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::device_rig {
namespace {

constexpr double kTick_hz = 1000.0;
// A reader that stood still reads what waits, as long as that takes no longer than this.
constexpr std::int64_t kCatchUp_ns = 10'000'000;

double milliseconds(std::int64_t ns) { return 1e-6 * static_cast<double>(ns); }

}  // namespace

std::string in_words(const IioSample& sample) {
  return fmt::format(
      "{} samples, {} old, {} times thrown away what waited, {} times opened again; longest read "
      "{:.1f} ms, longest throwing away {:.1f} ms",
      sample.count, sample.old, sample.skipped, sample.opened, milliseconds(sample.longest_read_ns),
      milliseconds(sample.longest_skip_ns));
}

IioLink::IioLink(const IioConfig& config, std::vector<std::string> channels, double factor)
    : factor_(factor), device_(config.uri, config.device, std::move(channels), kTick_hz) {
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

IioLink::~IioLink() {
  thread_.request_stop();
  device_.cancel();
}

void IioLink::work(const std::stop_token& stop) {
  constexpr std::int64_t kAgain_ns = 200'000'000;
  while (!stop.stop_requested()) {
    std::array<std::int64_t, kMostChannels> raw{};
    const std::int64_t begin_ns = runtime::monotonic_ns();
    const bool came = device_.read(raw);
    const std::int64_t took_ns = runtime::monotonic_ns() - begin_ns;
    sample_.longest_read_ns = std::max(sample_.longest_read_ns, took_ns);
    if (came) {
      take(raw);
      continue;
    }
    ++sample_.opened;
    begin_again();
    if (!stop.stop_requested()) runtime::sleep_until_ns(runtime::monotonic_ns() + kAgain_ns);
  }
}

void IioLink::begin_again() noexcept {
  clock_.clear();
  number_ = 0;
  behind_ns_ = 0;
}

// What waits comes one block a round trip: behind an iiod that is hardly quicker than the device,
// old samples would come for as long as the session lasts.
void IioLink::take_old(std::int64_t now_ns, bool too_slow) noexcept {
  ++sample_.old;
  sample_.old_at_ns = now_ns;
  samples_.store(sample_);
  const bool first = behind_ns_ == 0;
  if (first) behind_ns_ = now_ns;
  if (too_slow ? first : now_ns - behind_ns_ >= kCatchUp_ns) skip();
  if (too_slow) behind_ns_ = now_ns;
}

void IioLink::skip() noexcept {
  ++sample_.skipped;
  const std::int64_t begin_ns = runtime::monotonic_ns();
  device_.skip();
  sample_.longest_skip_ns = std::max(sample_.longest_skip_ns, runtime::monotonic_ns() - begin_ns);
  begin_again();
}

void IioLink::take(std::span<const std::int64_t> raw) noexcept {
  const std::int64_t now_ns = runtime::monotonic_ns();
  // The samples themselves count the device's time: one that waited in a buffer falls behind.
  const double rate_hz = device_.rate_hz() > 0.0 ? device_.rate_hz() : kTick_hz;
  const double counted_ms = 1e3 * static_cast<double>(number_) / rate_hz;
  number_ += device_.block();
  const auto verdict = clock_.step(static_cast<std::int16_t>(std::llround(counted_ms)),
                                   static_cast<double>(now_ns) / kNsPerMs);
  const bool too_slow = verdict == ReplyClock::Verdict::kTooSlow;
  if (too_slow || verdict == ReplyClock::Verdict::kOld) return take_old(now_ns, too_slow);
  behind_ns_ = 0;
  for (std::size_t i = 0; i < device_.formats().size() && i < raw.size(); ++i) {
    const runtime::IioFormat& format = device_.formats()[i];
    sample_.values[i] =
        factor_ * iio_value(raw[i], format.offset, format.scale, format.lowest, format.highest);
  }
  ++sample_.count;
  sample_.at_ns = now_ns;
  samples_.store(sample_);
  // A slow clock, or a reader that carries less than comes: after this it is neither.
  if (verdict == ReplyClock::Verdict::kDrifted) skip();
}

}  // namespace stillhand::device_rig
