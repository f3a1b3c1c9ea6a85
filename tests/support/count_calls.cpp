// SPDX-License-Identifier: Apache-2.0
// A library to preload: counts what a control path must not do, allocations and locks, by whom they
// were asked for: the program's own code (services and cores are linked into it) or a library
// (Fast DDS, the C++ library on its own behalf).  The counts are in the file
// $STILLHAND_COUNTS/<name of the program>, four native 64-bit numbers: allocations of the program,
// allocations of libraries, locks of the program, locks of libraries.  Used by loop_calls.py.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <string>
#include <string_view>

namespace {

struct Counts {
  std::atomic<std::uint64_t> own_allocations, other_allocations, own_locks, other_locks;
};

Counts fallback{};
Counts* counts = &fallback;
std::uintptr_t program_begin = 0;
std::uintptr_t program_end = 0;

// The first lines of /proc/self/maps are those of the program itself.
void find_program() {
  char path[512] = {};
  const ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - 1);
  const int maps = open("/proc/self/maps", O_RDONLY | O_CLOEXEC);
  static char text[1 << 18];
  std::size_t size = 0;
  for (ssize_t got = 0; (got = read(maps, text + size, sizeof(text) - 1 - size)) > 0;) {
    size += static_cast<std::size_t>(got);
  }
  close(maps);
  const std::string_view name(path, length > 0 ? static_cast<std::size_t>(length) : 0);
  std::string_view rest(text, size);
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    if (line.size() < name.size() || line.substr(line.size() - name.size()) != name) continue;
    char* dash = nullptr;
    const std::uintptr_t begin = std::strtoul(line.data(), &dash, 16);
    if (program_begin == 0) program_begin = begin;
    program_end = std::strtoul(dash + 1, nullptr, 16);
  }
  const char* folder = std::getenv("STILLHAND_COUNTS");
  if (folder == nullptr) return;
  std::string file(folder);
  file += name.substr(name.rfind('/'));
  const int shared = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (shared < 0 || ftruncate(shared, sizeof(Counts)) != 0) return;
  void* const place = mmap(nullptr, sizeof(Counts), PROT_READ | PROT_WRITE, MAP_SHARED, shared, 0);
  if (place != MAP_FAILED) counts = static_cast<Counts*>(place);
  close(shared);
}

[[gnu::constructor]] void start() { find_program(); }

bool is_own(const void* caller) noexcept {
  const auto address = reinterpret_cast<std::uintptr_t>(caller);
  return address >= program_begin && address < program_end;
}

void note_allocation(const void* caller) noexcept {
  auto& count = is_own(caller) ? counts->own_allocations : counts->other_allocations;
  count.fetch_add(1, std::memory_order_relaxed);
}

void note_lock(const void* caller) noexcept {
  auto& count = is_own(caller) ? counts->own_locks : counts->other_locks;
  count.fetch_add(1, std::memory_order_relaxed);
}

template <typename Function>
Function next(const char* name) noexcept {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);               // NOLINT: the C library's own names
void* __libc_calloc(std::size_t, std::size_t);  // NOLINT
void* __libc_realloc(void*, std::size_t);       // NOLINT

void* malloc(std::size_t size) {
  note_allocation(__builtin_return_address(0));
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note_allocation(__builtin_return_address(0));
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  note_allocation(__builtin_return_address(0));
  return __libc_realloc(old, size);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static const auto real = next<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  note_lock(__builtin_return_address(0));
  return real(mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
  static const auto real = next<int (*)(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
  note_lock(__builtin_return_address(0));
  return real(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
  static const auto real = next<int (*)(pthread_rwlock_t*)>("pthread_rwlock_wrlock");
  note_lock(__builtin_return_address(0));
  return real(lock);
}
}

// The program's `new` would otherwise count as the C++ library's.
void* operator new(std::size_t size) {
  note_allocation(__builtin_return_address(0));
  if (void* const place = __libc_malloc(size == 0 ? 1 : size)) return place;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) {
  note_allocation(__builtin_return_address(0));
  if (void* const place = __libc_malloc(size == 0 ? 1 : size)) return place;
  throw std::bad_alloc();
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete[](void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t /*size*/) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t /*size*/) noexcept { std::free(place); }
