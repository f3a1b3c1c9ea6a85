// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <array>
#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "services/system/process/switch_trace.hpp"

namespace stillhand::runtime {

/// What the kernel counted for a thread, proc_pid_schedstat(5), and for its process, getrusage(2).
struct ThreadAccount {
  std::int64_t at_ns = 0;       ///< when it was read
  std::int64_t ran_ns = 0;      ///< on a processor
  std::int64_t waited_ns = 0;   ///< runnable, without a processor
  std::int64_t disk_pages = 0;  ///< of the process: page faults that a disk had to answer
  std::int64_t continued = 0;   ///< SIGCONT that came
};

/// A thread that stood still.
struct Stall {
  double late_s = 0.0;  ///< from one beat to the next
  std::string why;      ///< "waited 71 ms for a processor"; empty: the kernel does not tell
};

/// Why a thread was silent from `from_ns` to `until_ns`: what the account grew by in this time,
/// beyond what it grows by otherwise, and what its processor did meanwhile.  Pure.
/// @param earlier  the account before `before`: the usual growth
/// @param before   the last one before the silence
/// @param after    the first one behind it
/// @param call     the system call that it was in, where look() saw one: "write()"
std::string why_silent(std::int64_t from_ns, std::int64_t until_ns, const ThreadAccount& earlier,
                       const ThreadAccount& before, const ThreadAccount& after,
                       const Occupation& meanwhile = {}, std::string_view call = {});

/// Notices that a thread stood still, and says why.  Needs no rights: a process may read its own
/// accounts.  Who had the processor is known where SwitchTrace is to be had.  Costs the thread one
/// reading of the clock a beat.
class StallWatch {
 public:
  /// Blocks SIGCONT for this thread and those it starts, so that step() can count it; a thread that
  /// does not block it takes it away.
  /// @param traces_switches  also asks SwitchTrace who had the processor
  explicit StallWatch(bool traces_switches = false);
  ~StallWatch();
  StallWatch(const StallWatch&) = delete;
  StallWatch& operator=(const StallWatch&) = delete;

  /// From the thread that is watched, once a turn.  Never locks or allocates.
  void beat() noexcept;
  /// From another thread, fifty times a second: sees a system call that lasts, proc_pid_syscall(5).
  void look();
  /// From the same thread as look(), ten times a second.
  /// @return a silence of 5 ms or more that ended since the call before: the longest
  std::optional<Stall> step();

 private:
  struct Silence {
    std::int64_t from_ns, until_ns;
    int processor;  // -1: the thread moved
  };
  [[nodiscard]] ThreadAccount account();
  [[nodiscard]] Occupation meanwhile(const Silence& silence);

  std::atomic<pid_t> thread_{0};
  std::atomic<std::int64_t> last_ns_{0};  // written by the thread that is watched
  int last_processor_ = -1;               // of that thread
  boost::lockfree::spsc_queue<Silence, boost::lockfree::capacity<16>> silences_;
  std::array<ThreadAccount, 64> accounts_{};  // newest first, 6 s
  std::int64_t continued_ = 0;
  int schedstat_ = -1;  // kept open: two calls a look
  std::optional<SwitchTrace> switches_;
  std::int64_t asked_ns_ = 0;      // the trace
  std::int64_t looked_at_ns_ = 0;  // begin of the silence that look() saw
  std::string_view call_;          // of that silence
};

}  // namespace stillhand::runtime
