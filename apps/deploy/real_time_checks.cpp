// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/real_time_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>
#include <thread>

#include "services/core/contract/tick.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::deploy {
namespace {

namespace fs = std::filesystem;

constexpr double kTick_us = 1e6 * kControlPeriod_s;
// A tenth of a tick, our own choice: less is lost in what the loop needs by itself.
constexpr int kMostIdleLatency_us = 100;

std::optional<long> number_in(std::string_view text) {
  long value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  return value;
}

std::vector<IdleState> idle_states() {
  std::vector<IdleState> states;
  std::error_code error;
  for (const auto& state : fs::directory_iterator("/sys/devices/system/cpu/cpu0/cpuidle", error)) {
    const fs::path folder = state.path();
    states.push_back({recording::text_of(folder / "name"), recording::text_of(folder / "latency"),
                      recording::text_of(folder / "disable")});
  }
  return states;
}

// The interrupts of a device or of the bus that carries it, such as a USB port's.
std::vector<std::string> processors_of(fs::path device) {
  std::vector<std::string> processors;
  std::error_code error;
  for (device = fs::canonical(device, error); device.has_relative_path() && processors.empty();
       device = device.parent_path()) {
    for (const auto& interrupt : fs::directory_iterator(device / "msi_irqs", error)) {
      const std::string text = recording::text_of(
          fs::path("/proc/irq") / interrupt.path().filename() / "effective_affinity_list");
      if (!text.empty()) processors.push_back(text.substr(0, text.find('\n')));
    }
  }
  return processors;
}

std::vector<ServedDevice> served_devices() {
  std::vector<ServedDevice> devices;
  for (const char* kind : {"net", "tty"}) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(fs::path("/sys/class") / kind, error)) {
      const std::string name = entry.path().filename();
      // Machines announce serial ports of 1981 that they do not have.
      if (name.starts_with("ttyS") || !fs::exists(entry.path() / "device", error)) continue;
      auto processors = processors_of(entry.path() / "device");
      if (!processors.empty()) devices.push_back({name, std::move(processors)});
    }
  }
  return devices;
}

std::optional<std::vector<double>> wake_ups(int count) {
  std::optional<std::vector<double>> lateness_us;
  std::thread([&] {
    if (!runtime::become_real_time()) return;
    lateness_us.emplace();
    constexpr auto kPeriod_ns = static_cast<std::int64_t>(1e9 * kControlPeriod_s);
    std::int64_t next_ns = runtime::monotonic_ns();
    for (int i = 0; i < count; ++i) {
      next_ns += kPeriod_ns;
      runtime::sleep_until_ns(next_ns);
      lateness_us->push_back(1e-3 * static_cast<double>(runtime::monotonic_ns() - next_ns));
    }
  }).join();
  return lateness_us;
}

}  // namespace

Finding check_preemption(std::string_view version, std::string_view mode) {
  const auto has = [](std::string_view text, std::string_view word) {
    return text.find(word) != std::string_view::npos;
  };
  if (has(version, "PREEMPT_RT")) {
    return {"preemption", State::kGood, "PREEMPT_RT: the kernel itself gives way", {}};
  }
  const std::string mend =
      "boot with preempt=full, or with the package linux-image-rt-amd64 "
      "(linux-image-rt-arm64)";
  if (has(mode, "(full)") || (has(version, "PREEMPT") && !has(version, "PREEMPT_DYNAMIC"))) {
    return {"preemption",
            State::kGood,
            "full, without PREEMPT_RT: the kernel gives way but for short parts of its work",
            {}};
  }
  if (has(version, "PREEMPT_DYNAMIC") && mode.empty()) {
    return {"preemption", State::kNotChecked, "the kernel chose its model at the start",
            "sudo cat /sys/kernel/debug/sched/preempt; if it is not (full): " + mend};
  }
  return {"preemption", State::kWrong, "the kernel finishes its work before a thread of the loop",
          mend};
}

Finding check_throttling(std::string_view runtime_us, std::string_view period_us) {
  const auto runtime = number_in(runtime_us);
  const auto period = number_in(period_us);
  if (!runtime || !period || *period <= 0) {
    return {"throttling", State::kNotChecked, "the kernel gives no share", {}};
  }
  if (*runtime < 0) return {"throttling", State::kGood, "real-time threads are never paused", {}};
  const double share = static_cast<double>(*runtime) / static_cast<double>(*period);
  const std::string what = fmt::format("real-time threads have {:.0f} % of the time", 1e2 * share);
  // The loop needs less than half of a processor (tests/benchmark/README.md).
  if (share >= 0.5) return {"throttling", State::kGood, what, {}};
  return {"throttling", State::kWrong, what, "sudo sysctl -w kernel.sched_rt_runtime_us=950000"};
}

Finding check_idle_states(const std::vector<IdleState>& states) {
  if (states.empty()) return {"idle-states", State::kNotChecked, "the processors show none", {}};
  long worst_us = 0;
  std::string name = "none";
  for (const IdleState& each : states) {
    const long latency_us = number_in(each.latency).value_or(0);
    if (each.disable.starts_with("1") || latency_us < worst_us) continue;
    worst_us = latency_us;
    name = each.name.substr(0, each.name.find('\n'));
  }
  const std::string what = fmt::format("the deepest is {}, {} us to leave it", name, worst_us);
  if (worst_us <= kMostIdleLatency_us) return {"idle-states", State::kGood, what, {}};
  return {"idle-states", State::kWrong, what,
          fmt::format("sudo apt install linux-cpupower; sudo cpupower idle-set -D {}, again after "
                      "each restart",
                      kMostIdleLatency_us)};
}

Finding check_interrupts(const std::vector<ServedDevice>& devices) {
  std::vector<std::string> lines;
  for (const ServedDevice& each : devices) {
    lines.push_back(
        fmt::format("{} on processor {}", each.device,
                    fmt::join(std::set(each.processors.begin(), each.processors.end()), ", ")));
  }
  if (lines.empty()) {
    return {"interrupts", State::kNotChecked, "no network or serial device shows its own", {}};
  }
  return {"interrupts", State::kGood, fmt::format("{}", fmt::join(lines, "; ")), {}};
}

Finding check_wake_ups(std::optional<std::vector<double>> lateness_us) {
  if (!lateness_us || lateness_us->empty()) {
    return {"wake-up", State::kNotChecked, "no real-time priority is granted", {}};
  }
  std::vector<double>& late = *lateness_us;
  std::ranges::sort(late);
  const auto at = [&](double share) {
    return late[static_cast<std::size_t>(share * static_cast<double>(late.size() - 1))];
  };
  const std::string what =
      fmt::format("late by {:.0f} us in the median of {}, 1 of 100 by {:.0f}, the worst by {:.0f}",
                  at(0.5), late.size(), at(0.99), late.back());
  if (late.back() < kTick_us) return {"wake-up", State::kGood, what, {}};
  return {"wake-up", State::kWrong, what + ": a tick is lost",
          "deploy/REAL_TIME.md; look again with the programs running that run in a session"};
}

std::vector<Finding> check_real_time_kernel() {
  const fs::path kernel = "/proc/sys/kernel";
  constexpr int kWakeUps = 2000;
  return {check_preemption(recording::text_of("/proc/version"),
                           recording::text_of("/sys/kernel/debug/sched/preempt")),
          check_throttling(recording::text_of(kernel / "sched_rt_runtime_us"),
                           recording::text_of(kernel / "sched_rt_period_us")),
          check_idle_states(idle_states()), check_interrupts(served_devices()),
          check_wake_ups(wake_ups(kWakeUps))};
}

}  // namespace stillhand::deploy
