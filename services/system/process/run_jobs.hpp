// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace stillhand::runtime {

/// Number of cores, at least 1.
unsigned core_count() noexcept;

/// Runs job(0) to job(count - 1), each once, on several threads; returns when all threads have
/// ended.  From the first call on, the process keeps memory that it frees, up to 256 MB.  After a
/// job throws no further one starts, and the exception of the lowest index that
/// failed is thrown here.
/// @param threads   at least 1
/// @param on_done   is given the number of finished jobs, in this thread, after each and at least
///                  every 100 ms; false stops.  Without it this thread is one of the workers.
/// @return false when on_done stopped the run
bool run_jobs(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& job,
              const std::function<bool(std::size_t done)>& on_done = {});

/// run_jobs() on every core.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& job);

}  // namespace stillhand::runtime
