// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::runtime {

/// Asks for SCHED_FIFO for the calling thread and those it starts from now on (Fast DDS 2.9.1 has
/// no thread settings: its threads inherit).  @return false when the system does not grant it.
bool become_real_time() noexcept;

/// Keeps every page of this process that is or will be in use from being swapped out, where the
/// limit (RLIMIT_MEMLOCK) has room for a process: with less, later allocations would fail.
/// @return false when it hasn't, or the system does not grant it.
bool lock_memory() noexcept;

/// Lowers a real-time thread below the control path, for threads that report or write files.  They
/// stay real-time: they share locks with the control path inside Fast DDS (its send resources), and
/// an ordinary thread that is preempted while it holds one stalls the loop for as long as the
/// machine is busy (measured 2026-11: up to 200 ms beside a parallel build).
void become_background() noexcept;

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

/// SIGTERM for this process when its parent ends, so that a killed lab leaves nobody behind.
void end_with_parent() noexcept;

}  // namespace stillhand::runtime
