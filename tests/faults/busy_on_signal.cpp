// SPDX-License-Identifier: Apache-2.0
// What a thread of a program that knows nothing of it does when a signal comes, with LD_PRELOAD;
// tgkill(2) chooses the thread.  SIGRTMIN + 7: it spins for ever; whatever it held it keeps, and
// its processor is busy.  + 8: it works for 80 ms.  + 9: it writes a megabyte into the pipe
// STILLHAND_PIPE.  + 10: it reads the mapped file STILLHAND_MAPS, a page here and a page there, for
// 80 ms.  + 11: it reads a byte from the pipe.  Used by inject.py and causes.py.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <ctime>

namespace {

volatile std::sig_atomic_t turns = 0;

extern "C" void spin(int /*signal*/) {
  for (;;) turns = 1;
}

constexpr double kLasts_s = 0.08;
constexpr std::size_t kPage = 4096;

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

extern "C" void work(int /*signal*/) {
  const double from_s = seconds(CLOCK_THREAD_CPUTIME_ID);
  while (seconds(CLOCK_THREAD_CPUTIME_ID) < from_s + kLasts_s) turns = 1;
}

// Its buffer is larger than any pipe's room, so that the write waits for a reader.
extern "C" void write_much(int /*signal*/) {
  static char much[1 << 20];
  const int file = open(std::getenv("STILLHAND_PIPE"), O_WRONLY);
  turns = write(file, much, sizeof much) > 0;
  close(file);
}

// In an order that reading ahead does not help.
extern "C" void read_pages(int /*signal*/) {
  const int file = open(std::getenv("STILLHAND_MAPS"), O_RDONLY);
  const auto bytes = static_cast<std::size_t>(lseek(file, 0, SEEK_END));
  auto* map = static_cast<volatile char*>(mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file, 0));
  madvise(const_cast<char*>(map), bytes, MADV_RANDOM);
  const double from_s = seconds(CLOCK_MONOTONIC);
  for (std::size_t n = 1; seconds(CLOCK_MONOTONIC) < from_s + kLasts_s; ++n)
    turns = map[n * 7919 % (bytes / kPage) * kPage];
  munmap(const_cast<char*>(map), bytes);
  close(file);
}

extern "C" void read_byte(int /*signal*/) {
  const int file = open(std::getenv("STILLHAND_PIPE"), O_RDONLY);
  char byte = 0;
  turns = read(file, &byte, 1) > 0;
  close(file);
}

bool install(int number, void (*action)(int)) {
  struct sigaction installed{};
  installed.sa_handler = action;
  installed.sa_flags = SA_RESTART;
  return sigaction(SIGRTMIN + number, &installed, nullptr) == 0;
}

// Before main(), so that no thread exists without the action.
const bool installed = install(7, &spin) && install(8, &work) && install(9, &write_much) &&
                       install(10, &read_pages) && install(11, &read_byte);

}  // namespace
