// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/station.hpp"

#include <cmath>
#include <cstdlib>

#include "services/runtime/process/clock.hpp"

namespace stillhand::calibrate {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr int kFirst_ticks = 200;

/// Mean and sum of squares as they come (Welford 1962).
class Sum {
 public:
  void add(double value) noexcept {
    if (!std::isfinite(value)) {
      ++missing_;
      return;
    }
    ++count_;
    const double off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
  }
  [[nodiscard]] Readings readings() const noexcept {
    const double variance = count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0.0;
    return {mean_, std::sqrt(variance), count_, missing_};
  }

 private:
  std::int64_t count_ = 0;
  std::int64_t missing_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;
};

double counts_of(const rig::RawSample& raw) noexcept {
  constexpr std::int64_t kMost = std::int64_t{1} << 32;  // the plant's "no angle" is beyond it
  return std::llabs(raw.encoder_counts) < kMost ? static_cast<double>(raw.encoder_counts) : NAN;
}

}  // namespace

rig::RawSample Station::tick() {
  due_ns_ += kTick_ns;
  runtime::sleep_until_ns(due_ns_);
  const rig::RigInput nobody{};
  plant_.begin(Trial{}, tick_);
  rig::RigOutput output = plant_.sample(nobody);
  plant_.drive(nobody, output);
  ++tick_;
  return output.raw;
}

AllReadings Station::read(double seconds) {
  due_ns_ = runtime::monotonic_ns();
  for (int i = 0; i < kFirst_ticks; ++i) tick();
  std::array<Sum, device_rig::kCalibratedSignals.size()> sums;
  const auto ticks = static_cast<std::int64_t>(std::lround(seconds * 1e3));
  for (std::int64_t i = 0; i < ticks; ++i) {
    const rig::RawSample raw = tick();
    sums[0].add(raw.load_cell_v);
    sums[1].add(raw.accel_y_v);
    sums[2].add(counts_of(raw));
  }
  return {sums[0].readings(), sums[1].readings(), sums[2].readings()};
}

}  // namespace stillhand::calibrate
