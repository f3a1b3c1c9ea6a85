// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string_view>

namespace stillhand::runtime {

/// Real-time priority of the control path: below the kernel's threaded interrupts at 50.
inline constexpr int kControlPriority = 40;
/// Of the processes that listen to the loop: where cores are fewer than processes, the answer to a
/// sample goes first (measured: tests/benchmark/RESULTS.md, "The loop").
inline constexpr int kListenerPriority = 35;
/// kControlPriority for the processes between a sample and the motor command that answers it (rig,
/// sensing, cancellation), kListenerPriority for all others.
int priority_of(std::string_view service) noexcept;
/// [B] The RLIMIT_MEMLOCK that lock_memory() needs: several times the memory of a process.
inline constexpr std::uint64_t kMemoryToLock = std::uint64_t{1} << 30;

/// Asks for SCHED_FIFO for the calling thread and those it starts from now on (Fast DDS 2.9.1 has
/// no thread settings: its threads inherit).
/// @param secured  SCHED_RR instead.  Under security Fast DDS takes read-write locks for each
///                 message, and glibc's spins while another thread hands one over: with two
///                 spinning on two processors, that thread would never get its turn (measured
///                 2026-11: for minutes).  Turns of 100 ms end that; no thread of the loop runs for
///                 so long.
/// @return false when the system does not grant it.
bool become_real_time(bool secured = false, int priority = kControlPriority) noexcept;

/// Keeps every page of this process that is or will be in use from being swapped out, where the
/// limit (RLIMIT_MEMLOCK) has room for a process: with less, later allocations would fail.
/// @return false if the limit is too low or the system refuses.
bool lock_memory() noexcept;

/// Whose locks a thread takes.
enum class Locks : bool { kOwn, kFastDds };

/// Lowers a real-time thread below the control path, for threads that report or write files.  They
/// stay real-time: they share locks with the control path inside Fast DDS (its send resources), and
/// an ordinary thread that is preempted while it holds one stalls the loop for as long as the
/// machine is busy (measured 2026-11: up to 200 ms during a parallel build).  Of a secured process
/// only those go lower that share none: see become_real_time().
void become_background(Locks locks = Locks::kFastDds) noexcept;

/// Ordinary policy for the calling thread as long as this lives, then what it had before: for long
/// work (drawing, fitting) that holds no lock.
class OrdinaryWhile {
 public:
  OrdinaryWhile() noexcept;
  ~OrdinaryWhile();
  OrdinaryWhile(const OrdinaryWhile&) = delete;
  OrdinaryWhile& operator=(const OrdinaryWhile&) = delete;

 private:
  int policy_;
  int priority_;
};

/// SIGTERM for this process when its parent ends, so that a killed lab leaves no process behind; at
/// once if it has ended already.  @param parent  as the parent knows itself, before it starts this
void end_with_parent(pid_t parent) noexcept;

}  // namespace stillhand::runtime
