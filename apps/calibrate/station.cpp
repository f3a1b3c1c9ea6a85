// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/station.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::calibrate {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr std::int64_t kMostCatchUp_ns = 5 * kTick_ns;
constexpr Tick kFirst_ticks = 200;
constexpr std::int64_t kEngaging = 1'000'000;  // apart from the trials of pushes

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

}  // namespace

double counts_of(const rig::RawSample& raw) noexcept {
  constexpr std::int64_t kMost = std::int64_t{1} << 32;  // the plant's "no angle" is beyond it
  return std::llabs(raw.encoder_counts) < kMost ? static_cast<double>(raw.encoder_counts) : NAN;
}

double in_units(device_rig::CalibratedSignal signal, double reading,
                const sensing::Config& sensing) noexcept {
  using device_rig::CalibratedSignal;
  switch (signal) {
    case CalibratedSignal::kForce:
      return (reading - sensing.load_cell_offset_v) / sensing.load_cell_sensitivity_v_n;
    case CalibratedSignal::kAcceleration:
      return (reading - sensing.accel_y_offset_v) / sensing.accel_sensitivity_v_m_s2;
    case CalibratedSignal::kAngle:
      break;
  }
  return 2.0 * std::numbers::pi * (reading - static_cast<double>(sensing.encoder_zero_counts)) /
         sensing.encoder_counts_per_rev;
}

rig::RigOutput Station::tick(const rig::RigInput& input, const Trial& trial) {
  due_ns_ += kTick_ns;
  runtime::sleep_until_ns(due_ns_);
  // As a session's rig: a little late it catches up, far behind it goes on from now.
  const std::int64_t late_ns = runtime::monotonic_ns() - due_ns_;
  if (late_ns > kMostCatchUp_ns) {
    due_ns_ += late_ns;
    lost_ns_ += late_ns;
  }
  plant_.begin(trial, tick_);
  rig::RigOutput output = plant_.sample(input);
  plant_.drive(input, output);
  ++tick_;
  return output;
}

Trial Station::engage(double place_m) {
  // The shortest way of Eq. SG-21, and the time to answer.
  constexpr Tick kEngage_ticks = 1500;
  constexpr Tick kLongest_ticks = 3'600'000;
  const Trial trial{.number = kEngaging + engaged_++,
                    .phase = TrialPhase::kPegged,
                    .start_tick = tick_ + kEngage_ticks,
                    .duration_ticks = kLongest_ticks};
  rig::RigInput input{.leave = MotionLeave::kEngage};
  input.command_valid = true;
  input.command_position_m = place_m;
  for (Tick i = 0; i < kEngage_ticks; ++i) tick(input, trial);
  return trial;
}

void Station::restart_clock() {
  due_ns_ = runtime::monotonic_ns();
  lost_ns_ = 0;
}

const rig::RigConfig& Station::in_real_time(const rig::RigConfig& rig) {
  runtime::become_real_time();
  return rig;
}

rig::RigOutput Station::rest(Tick ticks) {
  rig::RigOutput output = tick();
  for (Tick i = 1; i < ticks; ++i) output = tick();
  return output;
}

AllReadings Station::read(double seconds) {
  restart_clock();
  rest(kFirst_ticks);
  std::array<Sum, device_rig::kCalibratedSignals.size()> sums;
  const auto ticks = static_cast<std::int64_t>(std::lround(seconds * 1e3));
  for (std::int64_t i = 0; i < ticks; ++i) {
    const rig::RawSample raw = tick().raw;
    sums[0].add(raw.load_cell_v);
    sums[1].add(raw.accel_y_v);
    sums[2].add(counts_of(raw));
  }
  return {sums[0].readings(), sums[1].readings(), sums[2].readings()};
}

}  // namespace stillhand::calibrate
