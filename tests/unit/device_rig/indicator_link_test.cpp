// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/indicator_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <mutex>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/devices/device_rig/device_plant.hpp"
#include "services/system/process/clock.hpp"
#include "tests/emulators/indicator_side.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::device_rig {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kMs_ns = 1'000'000;

/// An emulated indicator in a thread of its own.
class EmulatedIndicator {
 public:
  EmulatedIndicator() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      std::int64_t due_ns = runtime::monotonic_ns();
      while (!stop.stop_requested()) {
        runtime::sleep_until_ns(due_ns += kMs_ns);
        const std::lock_guard lock(mutex_);
        side_.step(force_n, runtime::monotonic_ns());
      }
    });
  }
  void with(const std::function<void(emulators::IndicatorSide&)>& use) {
    const std::lock_guard lock(mutex_);
    use(side_);
  }
  [[nodiscard]] IndicatorConfig config() const {
    IndicatorConfig config;
    config.port = link_;
    return config;
  }
  std::atomic<double> force_n{2.0};

 private:
  std::string link_ =
      std::filesystem::temp_directory_path() / ("stillhand-indicator-" + std::to_string(getpid()));
  std::mutex mutex_;
  emulators::IndicatorSide side_{link_};
  std::jthread thread_;  // last
};

bool comes(const std::function<bool()>& is_there) {
  const std::int64_t until_ns = runtime::monotonic_ns() + 5000 * kMs_ns;
  while (!is_there()) {
    if (runtime::monotonic_ns() > until_ns) return false;
    runtime::sleep_until_ns(runtime::monotonic_ns() + kMs_ns);
  }
  return true;
}

std::string refusal(const IndicatorConfig& config) {
  return support::refusal([&] { const IndicatorLink sut(config); });
}

// A line has three decimals of a gram: 5e-6 N.
constexpr double kHalfStep_n = 5e-6;

class IndicatorLinkTest : public testing::Test {
 protected:
  EmulatedIndicator device_;
};

TEST_F(IndicatorLinkTest, TheNewestLineIsTheForce) {
  IndicatorLink sut(device_.config());
  EXPECT_TRUE(comes([&] { return std::abs(sut.newest().force_n - 2.0) <= kHalfStep_n; }));
  device_.force_n = -7.5;
  EXPECT_TRUE(comes([&] { return std::abs(sut.newest().force_n + 7.5) <= kHalfStep_n; }));
}

TEST_F(IndicatorLinkTest, AnotherRateThanTheSettingsSayIsRefused) {
  IndicatorConfig config = device_.config();
  config.rate_hz = 1000.0;
  EXPECT_THAT(refusal(config),
              HasSubstr("lines/s, want 1000 within 0.5 %, which devices.indicator.rate_hz"));
}

// The clock of DR-10 forgives 1 %: the lines would be old as soon as the session runs.
TEST_F(IndicatorLinkTest, ARateThatTheClockWouldNotForgiveIsRefused) {
  IndicatorConfig config = device_.config();
  config.rate_hz = 510.0;
  EXPECT_THAT(refusal(config), HasSubstr("lines/s, want 510 within 0.5 %"));
}

TEST_F(IndicatorLinkTest, HalfALineFromBeforeTheCableWasPulledIsNoPartOfTheNext) {
  IndicatorLink sut(device_.config());
  device_.with([&](auto& side) {
    const std::uint64_t before = sut.newest().count;
    side.serial().write(emulators::indicator_line(2.0) + "N,+00", runtime::monotonic_ns());
    EXPECT_TRUE(comes([&] { return sut.newest().count > before; }));
    side.serial().pull_out();
    side.serial().put_in();
  });
  const std::uint64_t before = sut.newest().count;
  EXPECT_TRUE(comes([&] { return sut.newest().count > before + 10; }));
  EXPECT_EQ(sut.newest().damaged, 0u);
}

TEST_F(IndicatorLinkTest, APortWithoutLinesOrWithOtherBytesIsRefused) {
  device_.with([](auto& side) { side.serial().mischief.garbage = true; });
  EXPECT_THAT(refusal(device_.config()), HasSubstr("want"));
  device_.with([](auto& side) { side.serial().mischief = {.silent = true}; });
  EXPECT_THAT(refusal(device_.config()), HasSubstr("no line in 0.5 s"));
  IndicatorConfig config = device_.config();
  config.port = "/dev/there-is-none";
  EXPECT_THAT(refusal(config),
              HasSubstr("devices.indicator: serial port /dev/there-is-none: got No such file"));
  config = device_.config();
  config.baud = 100000;
  EXPECT_THAT(refusal(config), HasSubstr("100000 Bd, want one of 9600"));
}

TEST_F(IndicatorLinkTest, ACableThatWasPulledOutAndPutInAgainBringsTheLinesBack) {
  IndicatorLink sut(device_.config());
  device_.with([](auto& side) { side.serial().pull_out(); });
  std::uint64_t before = sut.newest().count;
  EXPECT_TRUE(comes([&] {
    const std::uint64_t last = before;
    before = sut.newest().count;
    return runtime::monotonic_ns() - sut.newest().at_ns > 50 * kMs_ns && before == last;
  }));
  device_.with([](auto& side) { side.serial().put_in(); });
  EXPECT_TRUE(comes([&] { return sut.newest().count > before + 10; }));
}

TEST_F(IndicatorLinkTest, LinesThatAreHeldUpBecomeOld) {
  IndicatorLink sut(device_.config());
  ASSERT_TRUE(comes([&] { return sut.newest().count > 0; }));
  device_.with([](auto& side) { side.serial().mischief.late_ms = 100.0; });
  EXPECT_TRUE(comes([&] { return sut.newest().old > 10; }));
  EXPECT_GT(sut.newest().old_at_ns, 0);
}

TEST_F(IndicatorLinkTest, ThePlantPublishesTheForceAndKnowsASilentOrOverloadedCell) {
  DevicesConfig devices;
  devices.signals.force = "indicator";
  devices.indicator = device_.config();
  devices.indicator.sign = -1;
  DevicePlant sut({}, devices);
  EXPECT_THAT(sut.device_of(CalibratedSignal::kForce), HasSubstr("indicator at "));
  EXPECT_THAT(sut.device_of(CalibratedSignal::kForce), HasSubstr("sign -1"));
  Tick tick = 0;
  const auto step = [&] {
    sut.begin({}, ++tick);
    return sut.sample({}).raw.load_cell_v / 0.1;  // V/N, the default of sensing
  };
  EXPECT_TRUE(comes([&] { return std::abs(step() + 2.0) <= kHalfStep_n; }));
  device_.with([](auto& side) { side.overload(true); });
  EXPECT_TRUE(comes([&] { return std::isnan(step()) && sut.unsound() != nullptr; }));
  EXPECT_THAT(sut.unsound(), HasSubstr("load cell is silent"));
  device_.with([](auto& side) { side.overload(false); });
  EXPECT_TRUE(comes([&] { return std::abs(step() + 2.0) <= kHalfStep_n; }));
  device_.with([](auto& side) { side.serial().mischief.silent = true; });
  EXPECT_TRUE(comes([&] { return std::isnan(step()); }));
}

}  // namespace
}  // namespace stillhand::device_rig
