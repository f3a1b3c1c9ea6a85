// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::runtime {

/// Asks for SCHED_FIFO for the calling thread and those it starts from now on (Fast DDS 2.9.1 has
/// no thread settings: its threads inherit).  @return false when the system does not grant it.
bool become_real_time(int priority) noexcept;

/// Back to the ordinary policy, for threads that render, write files or report.
void become_ordinary() noexcept;

/// SIGTERM for this process when its parent ends, so that a killed lab leaves nobody behind.
void end_with_parent() noexcept;

}  // namespace stillhand::runtime
