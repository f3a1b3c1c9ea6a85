// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "services/bus/tap.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/rig/rig.hpp"
#include "services/system/process/latest_value.hpp"
#include "tests/emulators/moteus_emulator.hpp"
#include "tests/emulators/platform_emulator.hpp"

namespace stillhand::emulators {

/// What the session's simulated person does with the emulated stick: a witness on the bus, outside
/// of the session.  The force of `operator_force` is that of a hand, and the peg is in while a
/// pegged trial runs.
class Person {
 public:
  Person(std::uint32_t domain, const std::filesystem::path& profiles);
  ~Person();
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;

  /// Puts the person's part into the input.  One thread.
  void put(rig::RigInput& input);

 private:
  struct Push {
    bool valid = false;
    Tick tick = 0;
    double force_n = 0.0;
  };
  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);

  // One writer thread each: a tap has a reader for each topic.
  runtime::LatestValue<Push> push_;
  runtime::LatestValue<Trial> trial_;
  std::atomic<Tick> tick_{-1};
  std::unique_ptr<runtime::Tap> tap_;
};

/// Body, stick and platform of the emulated laboratory: the simulated rig's own core, driven by the
/// torque of the emulated drive and the set-points of the emulated platform.
class Laboratory {
 public:
  Laboratory(const rig::RigConfig& config, MoteusEmulator& drive, PlatformEmulator& platform);

  /// One millisecond.
  void step(std::int64_t now_ns, Person* person);
  /// The encoder slips by so much.
  void slip(double angle_rev) { slip_rev_ += angle_rev; }
  /// What a person does who calibrates: a force on the load cell, an accelerometer that is tilted,
  /// a stick that is turned by hand.
  void pull(double force_n) { pull_n_ = force_n; }
  void tilt(double acceleration_m_s2) { tilt_m_s2_ = acceleration_m_s2; }
  void turn(double angle_rad) { wanted_turn_rad_ = angle_rad; }
  /// The load cell's wires are the wrong way round.
  void swap_wires(bool swapped) { swapped_ = swapped; }
  /// The accelerometer is turned round.
  void turn_round(bool turned) { turned_ = turned; }
  /// The accelerometer's amplifier sticks at its end.
  void saturate(bool saturated) { saturated_ = saturated; }
  /// The accelerometer's input gives the number that it gave last.
  void hold_acceleration(bool held) { held_ = held; }
  /// The platform's own accelerometer gives no number.
  void lose_acceleration(bool lost) { seat_unknown_ = lost; }
  [[nodiscard]] const rig::RawSample& raw() const { return output_.raw; }
  [[nodiscard]] const rig::RigTruth& truth() const { return output_.truth; }

 private:
  double lever_m_;
  rig::Rig rig_;
  MoteusEmulator& drive_;
  PlatformEmulator& platform_;
  rig::RigOutput output_{};
  double slip_rev_ = 0.0;
  double pull_n_ = 0.0, tilt_m_s2_ = 0.0;
  double turn_rad_ = 0.0, wanted_turn_rad_ = 0.0;
  bool saturated_ = false;
  bool held_ = false;
  bool seat_unknown_ = false;
  bool swapped_ = false;
  bool turned_ = false;
  double accel_v_ = 0.0;
};

}  // namespace stillhand::emulators
