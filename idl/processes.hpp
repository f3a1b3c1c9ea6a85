// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace stillhand::topics {

/// One process of a session.
struct Process {
  std::string_view name;   ///< on the bus; its executable is stillhand-NAME
  int launch = 0;          ///< place in the order of the launches, from 1; 0: a person starts it
  bool prepares = false;   ///< reports that it is prepared (armed_trial) before a trial begins
  bool ticks = false;      ///< reports ticks from the session's begin; without: during trials only
  bool ends_last = false;  ///< ends after all others, so that it sees them end
};

/// Every process of a session.  One row puts a process into the launches, the conductor, the logs,
/// the inventory, the permissions and the dashboard.  The order is the one in which reports list
/// them.  "experiment" is `stillhand lab`, which conducts the session.
inline constexpr std::array kProcesses{
    Process{.name = "motion", .launch = 4, .prepares = true, .ticks = true},
    Process{.name = "rig", .launch = 2, .prepares = true, .ticks = true},
    Process{.name = "sensing", .launch = 3, .ticks = true},
    Process{.name = "cancellation", .launch = 5, .prepares = true, .ticks = true},
    Process{.name = "display", .launch = 6, .prepares = true, .ticks = true},
    Process{.name = "human_operator", .launch = 7, .prepares = true},
    Process{.name = "identification", .launch = 8},
    Process{.name = "recorder", .launch = 1, .ticks = true, .ends_last = true},
    Process{.name = "experiment"}};

namespace detail {
constexpr bool launched(const Process& process) { return process.launch > 0; }
constexpr std::size_t kLaunchedCount =
    static_cast<std::size_t>(std::ranges::count_if(kProcesses, launched));

constexpr auto names() {
  std::array<std::string_view, kProcesses.size()> list;
  std::ranges::transform(kProcesses, list.begin(), &Process::name);
  return list;
}
constexpr auto launched_names() {
  std::array<std::string_view, kLaunchedCount> list;
  auto end = list.begin();
  for (const Process& process : kProcesses) {
    if (launched(process)) *end++ = process.name;
  }
  return list;
}
constexpr auto launch_order() {
  std::array<std::string_view, kLaunchedCount> list;
  for (const Process& process : kProcesses) {
    if (launched(process)) list.at(static_cast<std::size_t>(process.launch - 1)) = process.name;
  }
  return list;
}
}  // namespace detail

/// Names of all, in the table's order.
inline constexpr auto kServices = detail::names();
/// Names of those that `stillhand lab` starts, in the table's order.
inline constexpr auto kLaunched = detail::launched_names();
/// The same, in the order in which it starts them: the recorder is there when the others begin.
inline constexpr auto kLaunchOrder = detail::launch_order();
/// The process that ends after all others.
inline constexpr std::string_view kEndsLast =
    std::ranges::find_if(kProcesses, &Process::ends_last)->name;

/// True for the name of a process of a session.
constexpr bool is_service(std::string_view name) {
  return std::ranges::find(kServices, name) != kServices.end();
}

static_assert(std::ranges::count_if(kProcesses, &Process::ends_last) == 1);
static_assert(std::ranges::find(kLaunchOrder, std::string_view{}) == kLaunchOrder.end(),
              "the launches are counted from 1, each place once");

}  // namespace stillhand::topics
