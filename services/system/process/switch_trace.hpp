// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace stillhand::runtime {

/// What a processor did in the longest time between a leaving of a thread and its return to it.
struct Occupation {
  char left_as = 0;     ///< state in which the thread left it, ps(1): R, S, D, T, t; 0: not seen
  std::string program;  ///< that had it for longest; empty: none, or nobody knows
  std::int64_t had_ns = 0;
  std::int64_t idle_ns = 0;  ///< without any program
};

/// Pure.
/// @param trace  lines of the event sched_switch of one processor, oldest first, on the monotonic
///               clock: "... 12.345678: sched_switch: prev_comm=a prev_pid=1 ... ==> next_comm=b
///               ..."
Occupation occupation(std::string_view trace, pid_t thread, std::int64_t from_ns,
                      std::int64_t until_ns);

/// The kernel's own trace of which program each processor ran, ftrace(7) and
/// Documentation/trace/ftrace.rst: the last 16,000 switches of each processor, half a second of a
/// session. All processes of a session on a machine share it; the last one that ends removes it. It
/// is there where the process may write tracefs: by default, for root.
class SwitchTrace {
 public:
  explicit SwitchTrace(const std::filesystem::path& tracefs = "/sys/kernel/tracing");
  ~SwitchTrace();
  SwitchTrace(const SwitchTrace&) = delete;
  SwitchTrace& operator=(const SwitchTrace&) = delete;

  [[nodiscard]] bool available() const noexcept { return joined_ >= 0; }
  /// Reads the whole ring of the processor: 30 ms of work, so not often.
  [[nodiscard]] Occupation of(int processor, pid_t thread, std::int64_t from_ns,
                              std::int64_t until_ns) const;

 private:
  std::filesystem::path instance_;
  int joined_ = -1;  // an open file keeps the instance from being removed
};

}  // namespace stillhand::runtime
