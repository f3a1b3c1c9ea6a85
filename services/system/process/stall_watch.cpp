// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/stall_watch.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::runtime {
namespace {

constexpr std::int64_t kLeast_ns = 5'000'000;
constexpr const char* kHeldBack = "held back, as by its group's quota of processor time";
// Later than any wait for the next sample; kLooks of note_stalls() see it in any silence of 35 ms.
constexpr std::int64_t kLasts_ns = 12'000'000;
constexpr std::int64_t kWorthATrace_ns = 20'000'000;
constexpr std::int64_t kBetweenTraces_ns = 2'000'000'000;

sigset_t continue_signal() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGCONT);
  return set;
}

// Calls that wait for something else than the next sample: that one is a futex, a poll or a
// recvmsg.
std::string_view name_of(long call) {
  switch (call) {
    case SYS_read:
      return "read()";
    case SYS_write:
    case SYS_writev:
    case SYS_pwrite64:
      return "write()";
    case SYS_sendto:
    case SYS_sendmsg:
      return "sendmsg()";
    case SYS_fsync:
    case SYS_fdatasync:
      return "fsync()";
    case SYS_openat:
      return "open()";
    case SYS_ioctl:
      return "ioctl()";
    default:
      return {};
  }
}

// "1 0x3 ..." in call 1; "running"; "-1 ..." in none.
std::string_view call_of(pid_t thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/syscall");
  long call = -1;
  return file >> call ? name_of(call) : std::string_view{};
}

std::string milliseconds(std::int64_t ns) {
  return std::to_string((ns + 500'000) / 1'000'000) + " ms";
}

std::string taken_by(const Occupation& meanwhile, std::int64_t least_ns) {
  if (meanwhile.had_ns >= least_ns) {
    return "; " + meanwhile.program + " had it for " + milliseconds(meanwhile.had_ns);
  }
  // Ready next to an idle processor.
  if (meanwhile.idle_ns >= least_ns) return std::string("; it was idle: ") + kHeldBack;
  return {};
}

}  // namespace

std::string why_silent(std::int64_t from_ns, std::int64_t until_ns, const ThreadAccount& earlier,
                       const ThreadAccount& before, const ThreadAccount& after,
                       const Occupation& meanwhile, std::string_view call) {
  if (before.at_ns == 0 || before.at_ns > from_ns || after.at_ns < until_ns) return {};
  const std::int64_t silent_ns = until_ns - from_ns;
  // The share of the time outside of the silence that the thread usually spends so.
  const auto beyond_usual_ns = [&](std::int64_t ThreadAccount::* spent) {
    const std::int64_t usual_ns = before.at_ns - earlier.at_ns;
    const double share =
        earlier.at_ns == 0 || usual_ns <= 0
            ? 0.0
            : static_cast<double>(before.*spent - earlier.*spent) / static_cast<double>(usual_ns);
    const auto outside_ns = static_cast<double>(after.at_ns - before.at_ns - silent_ns);
    return static_cast<std::int64_t>(static_cast<double>(after.*spent - before.*spent) -
                                     share * outside_ns);
  };
  const std::int64_t waited_ns = beyond_usual_ns(&ThreadAccount::waited_ns);
  const std::int64_t ran_ns = beyond_usual_ns(&ThreadAccount::ran_ns);
  if (waited_ns > silent_ns / 2) {
    return "waited " + milliseconds(std::min(waited_ns, silent_ns)) + " for a processor" +
           taken_by(meanwhile, silent_ns / 2);
  }
  if (ran_ns > silent_ns / 2) return "worked for " + milliseconds(std::min(ran_ns, silent_ns));
  if (after.continued > before.continued) return "stopped by a signal";
  if (!call.empty()) return "blocked in " + std::string(call);
  if (const std::int64_t pages = after.disk_pages - before.disk_pages; pages > 0) {
    return "waited for " + std::to_string(pages) + " pages of memory from a disk";
  }
  switch (meanwhile.left_as) {
    case 'T':
      return "stopped by a signal";
    case 't':
      return "stopped by a debugger";
    case 'D':
      return "blocked in the kernel, as by a disk or its group's freezer";
    case 'R':  // ready, and yet it neither ran nor waited
      return after.ran_ns - before.ran_ns + after.waited_ns - before.waited_ns < silent_ns / 4
                 ? kHeldBack
                 : std::string{};
    default:
      return {};
  }
}

StallWatch::StallWatch(bool traces_switches) {
  if (traces_switches) switches_.emplace();
  const sigset_t set = continue_signal();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

StallWatch::~StallWatch() {
  if (schedstat_ >= 0) close(schedstat_);
}

void StallWatch::beat() noexcept {
  const std::int64_t now_ns = monotonic_ns();
  const int processor = sched_getcpu();
  const std::int64_t from_ns = last_ns_.exchange(now_ns, std::memory_order_relaxed);
  const int before = std::exchange(last_processor_, processor);
  if (from_ns == 0) {
    thread_.store(gettid(), std::memory_order_relaxed);
    return;
  }
  if (now_ns - from_ns < kLeast_ns) return;
  silences_.push({from_ns, now_ns, before == processor ? processor : -1});
}

ThreadAccount StallWatch::account() {
  const sigset_t set = continue_signal();
  const timespec at_once{};
  while (sigtimedwait(&set, nullptr, &at_once) == SIGCONT) ++continued_;
  ThreadAccount account;
  account.continued = continued_;
  std::array<char, 96> text{};  // "ran waited turns"
  if (pread(schedstat_, text.data(), text.size() - 1, 0) > 0) {
    char* rest = nullptr;
    account.ran_ns = std::strtoll(text.data(), &rest, 10);
    account.waited_ns = std::strtoll(rest, nullptr, 10);
  }
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) account.disk_pages = usage.ru_majflt;
  account.at_ns = monotonic_ns();
  return account;
}

// On a machine that is too busy, reading for each silence would make it busier.
Occupation StallWatch::meanwhile(const Silence& silence) {
  const std::int64_t now_ns = monotonic_ns();
  if (!switches_ || silence.processor < 0 || silence.until_ns - silence.from_ns < kWorthATrace_ns)
    return {};
  if (asked_ns_ != 0 && now_ns - asked_ns_ < kBetweenTraces_ns) return {};
  asked_ns_ = now_ns;
  const OrdinaryWhile ordinary;
  return switches_->of(silence.processor, thread_.load(std::memory_order_relaxed), silence.from_ns,
                       silence.until_ns);
}

void StallWatch::look() {
  const std::int64_t last_ns = last_ns_.load(std::memory_order_relaxed);
  if (last_ns == 0 || last_ns == looked_at_ns_ || monotonic_ns() - last_ns < kLasts_ns) return;
  looked_at_ns_ = last_ns;
  call_ = call_of(thread_.load(std::memory_order_relaxed));
}

std::optional<Stall> StallWatch::step() {
  const pid_t thread = thread_.load(std::memory_order_relaxed);
  if (thread == 0) return std::nullopt;
  if (schedstat_ < 0) {
    const std::string file = "/proc/self/task/" + std::to_string(thread) + "/schedstat";
    schedstat_ = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  }
  // First the silences, then the account: they ended before it.
  Silence longest{};
  silences_.consume_all([&](const Silence& each) {
    if (each.until_ns - each.from_ns > longest.until_ns - longest.from_ns) longest = each;
  });
  std::rotate(accounts_.begin(), accounts_.end() - 1, accounts_.end());
  accounts_.front() = account();
  if (longest.until_ns == 0) return std::nullopt;
  const auto* before =
      std::find_if(accounts_.begin() + 1, accounts_.end(),
                   [&](const ThreadAccount& each) { return each.at_ns <= longest.from_ns; });
  Stall stall;
  stall.late_s = 1e-9 * static_cast<double>(longest.until_ns - longest.from_ns);
  if (before != accounts_.end()) {
    const ThreadAccount earlier = before + 1 == accounts_.end() ? ThreadAccount{} : before[1];
    stall.why = why_silent(longest.from_ns, longest.until_ns, earlier, *before, accounts_.front(),
                           meanwhile(longest),
                           longest.from_ns == looked_at_ns_ ? call_ : std::string_view{});
  }
  return stall;
}

}  // namespace stillhand::runtime
