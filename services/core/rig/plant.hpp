// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>

#include "services/core/contract/trial.hpp"
#include "services/core/rig/rig.hpp"

namespace stillhand::rig {

/// What stands behind the rig's topics: the simulated rig, or devices
/// (services/devices/device_rig).  The shell steps it; clock, bus and interlock are the shell's.
/// One thread; no call waits, locks or allocates.
class Plant {
 public:
  Plant() = default;
  virtual ~Plant() = default;
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  /// Once a millisecond while the sample clock stands.
  virtual void wait() noexcept {}
  /// The halves of a tick that follow belong to it.
  virtual void begin(const Trial& trial, Tick tick) noexcept = 0;
  /// As those of Rig, Eq. RG-38.
  virtual RigOutput step(const RigInput& input) noexcept = 0;
  virtual RigOutput sample(const RigInput& input) noexcept = 0;
  virtual void drive(const RigInput& input, RigOutput& output) noexcept = 0;
  /// A trial may begin.
  [[nodiscard]] virtual bool prepared() const noexcept { return true; }
  /// Something that a person has to know, once; nullptr: nothing.  As unsound().
  [[nodiscard]] virtual const char* notice() noexcept { return nullptr; }
  /// Which parts are devices, for the recording; nullptr: none.
  [[nodiscard]] virtual const char* parts() const noexcept { return nullptr; }
  /// Why no force is permitted; nullptr: every part works.  The text lives as long as the plant.
  [[nodiscard]] virtual const char* unsound() const noexcept { return nullptr; }
};

/// The simulated rig.
class SimulatedPlant final : public Plant {
 public:
  /// @param effect  the undeclared effect; empty: none
  explicit SimulatedPlant(const RigConfig& config, SealedEffect effect = {})
      : core_(config, std::move(effect)) {}

  void begin(const Trial& /*trial*/, Tick /*tick*/) noexcept override {}
  RigOutput step(const RigInput& input) noexcept override { return core_.step(input); }
  RigOutput sample(const RigInput& input) noexcept override { return core_.sample(input); }
  void drive(const RigInput& input, RigOutput& output) noexcept override {
    core_.drive(input, output);
  }

 private:
  Rig core_;
};

/// The settings with the seed of a session.
inline RigConfig seeded(RigConfig config, std::uint64_t seed) {
  constexpr std::uint64_t kSeedMask = 0xffffffffu;  // RigConfig::seed is a 32-bit number
  config.seed = static_cast<std::int64_t>(seed & kSeedMask);
  return config;
}

}  // namespace stillhand::rig
