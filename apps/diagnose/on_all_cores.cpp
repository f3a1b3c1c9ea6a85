// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/on_all_cores.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace stillhand::diagnose {

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::exception_ptr error;
  const auto work = [&] {
    for (std::size_t i = 0; (i = next++) < count && !failed;) {
      try {
        task(i);
      } catch (...) {
        if (!failed.exchange(true)) error = std::current_exception();
      }
    }
  };
  std::vector<std::jthread> others;
  const unsigned cores = std::max(std::thread::hardware_concurrency(), 1U);
  for (unsigned i = 1; i < std::min<std::size_t>(cores, count); ++i) others.emplace_back(work);
  work();
  others.clear();
  if (error) std::rethrow_exception(error);
}

}  // namespace stillhand::diagnose
