// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/indicator_link.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/indicator_line.hpp"
#include "services/files/settings/placed_error.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::device_rig {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr int kSettle_ms = 100;
constexpr int kListen_ms = 500;
constexpr int kListenMost = 5;
// Half of what the clock forgives (DR-10): a busy machine shifts lines by some milliseconds, so
// that it takes seconds to know a rate so well.
constexpr double kRateShare = 0.005;
// No busy machine shifts lines by so much of half a second.
constexpr double kOtherRate = 0.1;

}  // namespace

IndicatorLink::IndicatorLink(const IndicatorConfig& config)
    : config_(config), port_(settings::placed("devices.indicator", [&] {
        return std::make_unique<runtime::SerialPort>(config.port, config.baud);
      })) {
  listen_first();
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

IndicatorLink::~IndicatorLink() {
  thread_.request_stop();
  bell_.ring();
}

void IndicatorLink::listen_first() {
  const std::string name = "indicator at " + config_.port;
  const auto listen = [this](int most_ms) {
    const std::int64_t until_ns = runtime::monotonic_ns() + most_ms * kMillisecond_ns;
    while (runtime::monotonic_ns() < until_ns && !port_->gone()) {
      bell_.wait(port_->descriptor(), 10);
      receive();
    }
  };
  listen(kSettle_ms);  // a piece of a line, and what waited in a buffer
  sample_ = {};
  clock_.clear();
  number_ = 0;
  listen(kListen_ms);
  if (number_ == 0) {
    throw ConfigError(name, "no line in 0.5 s",
                      "an indicator that streams, at devices.indicator.baud");
  }
  if (sample_.damaged > number_ / 10) {
    throw ConfigError(
        name, std::to_string(sample_.damaged) + " lines that are no force",
        "lines such as N,+0012.345,g,ST in g, kg, N or lb, at devices.indicator.baud");
  }
  // From the last line of the first half second to the newest: a whole number of lines.
  const std::uint64_t first = number_;
  const std::int64_t first_ns = line_ns_;
  double rate_hz = 0.0;
  for (int turn = 0; turn < kListenMost; ++turn) {
    listen(kListen_ms);
    if (number_ == first) break;
    rate_hz = 1e9 * static_cast<double>(number_ - first) / static_cast<double>(line_ns_ - first_ns);
    const double off = std::abs(rate_hz - config_.rate_hz) / config_.rate_hz;
    if (off <= kRateShare) return samples_.store(sample_);
    if (off > kOtherRate) break;
  }
  throw ConfigError(
      name, fmt::format("{:.1f} lines/s", rate_hz),
      fmt::format("{:g} within 0.5 %, which devices.indicator.rate_hz says", config_.rate_hz));
}

void IndicatorLink::work(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    bell_.wait(port_ ? port_->descriptor() : -1, kSettle_ms);
    if (!port_ || port_->gone()) open_again();
    if (port_) receive();
  }
}

void IndicatorLink::open_again() noexcept {
  port_.reset();
  clock_.clear();
  lines_ = {};  // half a line of before is none of the one that comes
  number_ = 0;
  try {
    port_ = std::make_unique<runtime::SerialPort>(config_.port, config_.baud);
  } catch (const std::exception&) {
    // Not there yet: the next turn tries again.
  }
}

void IndicatorLink::receive() noexcept {
  std::array<char, 1024> bytes{};
  // A device that never stops talking does not hold the thread.
  for (int turn = 0; turn < 8; ++turn) {
    const std::string_view text = port_->read(bytes);
    if (text.empty()) return;
    lines_.take(text, [this](std::string_view line) { take(line); });
  }
}

void IndicatorLink::take(std::string_view line) noexcept {
  const std::int64_t now_ns = runtime::monotonic_ns();
  line_ns_ = now_ns;
  // The lines themselves count the indicator's time, the damaged ones too.
  const double counted_ms = 1e3 * static_cast<double>(number_++) / config_.rate_hz;
  const auto verdict = clock_.step(static_cast<std::int16_t>(std::llround(counted_ms)),
                                   1e-6 * static_cast<double>(now_ns));
  const auto force_n = indicator_force_n(line);
  if (!force_n) {
    ++sample_.damaged;
  } else if (verdict == ReplyClock::Verdict::kOld) {
    ++sample_.old;
    sample_.old_at_ns = now_ns;
  } else {
    ++sample_.count;
    sample_.at_ns = now_ns;
    sample_.force_n = *force_n;
  }
  samples_.store(sample_);
}

}  // namespace stillhand::device_rig
