// SPDX-License-Identifier: Apache-2.0
// pushing_rig: the rig of devices without a session.  It pushes the stick with a constant force and
// moves the platform, each millisecond, as long as no part is unsound; as in a session, a force
// that was taken away stays away.  device_faults.py makes the faults.  Prints
//
//   pushing          from the first tick with a force on
//   unsound WHY      once, when a part is unsound first
//
// and ends with its standard input.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numbers>

#include "services/devices/device_rig/device_plant.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr Tick kEngaged_ticks = 1200;  // the shortest way of Eq. SG-21
constexpr double kForce_n = 5.0;
constexpr double kAmplitude_m = 0.02;
constexpr double kMotion_rad_s = 2.0 * std::numbers::pi * 1.5;

bool input_ended() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, 0) <= 0) return false;
  char bytes[64];
  return ::read(STDIN_FILENO, bytes, sizeof(bytes)) <= 0;
}

/// Constant force, and a platform that swings.
rig::RigInput wanted(Tick tick) {
  const double phase_rad = kMotion_rad_s * kControlPeriod_s * static_cast<double>(tick);
  rig::RigInput input;
  input.command_valid = true;
  input.command_position_m = kAmplitude_m * std::sin(phase_rad);
  input.command_velocity_m_s = kMotion_rad_s * kAmplitude_m * std::cos(phase_rad);
  input.command_acceleration_m_s2 = -kMotion_rad_s * kMotion_rad_s * input.command_position_m;
  input.motor_valid = true;
  input.motor_force_n = kForce_n;
  return input;
}

void push(device_rig::DevicePlant& plant) {
  // Announced until the devices are prepared; then it begins.
  Trial trial{.number = 1,
              .phase = TrialPhase::kTracking,
              .start_tick = Tick{1} << 40,
              .duration_ticks = Tick{1} << 40};
  std::int64_t due_ns = runtime::monotonic_ns();
  bool prepared = false;
  Tick prepared_ticks = 0;
  bool said = false;
  const char* why = nullptr;
  for (Tick tick = 0; !input_ended();) {
    due_ns += kTick_ns;
    runtime::sleep_until_ns(due_ns);
    // A process that stood still goes on from now, as the shell does.
    due_ns = std::max(due_ns, runtime::monotonic_ns() - 5 * kTick_ns);
    prepared_ticks = plant.prepared() ? prepared_ticks + 1 : 0;
    if (!prepared && prepared_ticks > kEngaged_ticks) {
      prepared = true;
      trial.start_tick = tick;
    }
    plant.begin(trial, tick);
    rig::RigInput input{.leave = MotionLeave::kEngage, .command_valid = true};
    if (prepared) input = wanted(tick - trial.start_tick);
    rig::RigOutput output = plant.sample(input);
    if (prepared && why == nullptr && plant.unsound() != nullptr) {
      why = plant.unsound();
      std::printf("unsound %s\n", why);
      std::fflush(stdout);
    }
    input.motor_permitted = prepared && why == nullptr;
    plant.drive(input, output);
    if (!said && output.truth.motor_force_n != 0.0) {
      std::puts("pushing");
      std::fflush(stdout);
      said = true;
    }
    ++tick;
  }
}

int run(int argc, char** argv) {
  std::filesystem::path config;
  command_line::Program cli("pushing_rig: the rig of devices, pushing, without a session");
  cli.add_option("--config", config, "folder with rig.yaml and devices.yaml").required();
  if (const auto status = cli.parse(argc, argv)) return *status;
  std::signal(SIGPIPE, SIG_IGN);  // as every process of a session
  runtime::end_with_parent(getppid());
  runtime::become_real_time();
  device_rig::DevicePlant plant(
      settings::load<rig::RigConfig>(config / "rig.yaml", "rig"),
      settings::load<device_rig::DevicesConfig>(config / "devices.yaml", "devices"));
  push(plant);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pushing_rig: %s\n", error.what());
    return 2;
  }
}
