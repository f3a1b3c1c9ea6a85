// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/deploy/checks.hpp"

/// How soon this machine's kernel lets a thread of real-time priority run.  deploy/REAL_TIME.md has
/// what each finding costs and how to mend it.
namespace stillhand::deploy {

/// The preemption model.
/// @param version  text of /proc/version
/// @param mode  text of /sys/kernel/debug/sched/preempt, which root reads: "none voluntary (full)"
Finding check_preemption(std::string_view version, std::string_view mode);

/// The share of the time that threads of real-time priority may use together.
/// @param runtime_us, period_us  texts of /proc/sys/kernel/sched_rt_runtime_us, sched_rt_period_us
Finding check_throttling(std::string_view runtime_us, std::string_view period_us);

/// An idle state of a processor; texts of the files of the same names in
/// /sys/devices/system/cpu/cpu*/cpuidle/state*.
struct IdleState {
  std::string name, latency, disable;
};
/// A processor that sleeps deeply wakes up late.
Finding check_idle_states(const std::vector<IdleState>& states);

/// A network or serial device and the processors that serve its interrupts, as the kernel lists
/// them: "0-3".
struct ServedDevice {
  std::string device;
  std::vector<std::string> processors;  ///< one for each interrupt
};
/// Never wrong: where they belong depends on the machine.
Finding check_interrupts(const std::vector<ServedDevice>& devices);

/// @param lateness_us  [us] by how much each wake-up of a real-time thread came late; nothing if
///                     the priority was not granted
Finding check_wake_ups(std::optional<std::vector<double>> lateness_us);

/// Those of this machine.  Takes two seconds, in which a thread sleeps a tick at a time.
std::vector<Finding> check_real_time_kernel();

}  // namespace stillhand::deploy
