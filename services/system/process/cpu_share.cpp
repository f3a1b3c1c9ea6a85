// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/cpu_share.hpp"

#include <unistd.h>

#include <ctime>
#include <fstream>
#include <limits>
#include <string>

#include "services/system/process/clock.hpp"

namespace stillhand::runtime {

double ShareMeter::step(std::int64_t used, std::int64_t whole, std::int64_t least) noexcept {
  if (!begun_) {
    begun_ = true;
    used_ = used;
    whole_ = whole;
    share_ = std::numeric_limits<double>::quiet_NaN();
  } else if (whole - whole_ >= least) {
    share_ = static_cast<double>(used - used_) / static_cast<double>(whole - whole_);
    used_ = used;
    whole_ = whole;
  }
  return share_;
}

double ProcessCpu::step() noexcept {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return meter_.step(used.tv_sec * kNsPerSecond + used.tv_nsec, monotonic_ns(), kNsPerSecond);
}

double HostCpu::step() {
  // proc(5): cpu user nice system idle iowait irq softirq steal, in clock ticks of all processors.
  std::ifstream stat("/proc/stat");
  std::string name;
  std::int64_t busy = 0, all = 0, ticks = 0;
  stat >> name;
  for (int column = 0; column < 8 && stat >> ticks; ++column) {
    const bool idle = column == 3 || column == 4;
    all += ticks;
    if (!idle) busy += ticks;
  }
  if (!stat || name != "cpu") return std::numeric_limits<double>::quiet_NaN();
  return meter_.step(busy, all, sysconf(_SC_CLK_TCK));
}

}  // namespace stillhand::runtime
