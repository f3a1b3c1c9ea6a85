// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/in_child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::uint64_t kDone = 1;
constexpr std::uint64_t kRefused = 2;
constexpr std::uint64_t kLongestText = std::uint64_t{1} << 20;
// A damaged file can send a library into an endless loop; 60 million values take seconds.
constexpr rlim_t kMostProcessor_s = 600;

struct FileClose {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileClose>;

File opened(int descriptor, const char* mode) {
  File file(fdopen(descriptor, mode));
  if (!file) throw std::system_error(errno, std::generic_category(), "fdopen");
  return file;
}

void limit(int resource, rlim_t most) {
  rlimit now{};
  if (getrlimit(resource, &now) != 0) return;
  now.rlim_cur = std::min(most, now.rlim_max);
  (void)setrlimit(resource, &now);
}

// In the child; never returns.  Nothing of the parent's is written, flushed or destroyed here.
[[noreturn]] void run_child(pid_t parent, int descriptor, const std::string& path,
                            const std::function<void(Wire&)>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it ended before
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, kMostProcessor_s);
  // What a library prints about a file goes nowhere: the parent says it in its own line.
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  std::FILE* file = fdopen(descriptor, "wb");
  if (file == nullptr) _exit(1);
  Wire wire(file, kDone);
  try {
    try {
      work(wire);
    } catch (const std::bad_alloc&) {
      throw Refused{path, "more values than this machine's memory holds", "a part of the file"};
    }
  } catch (const Refused& refused) {
    if (wire.begun()) _exit(1);
    Wire refusal(file, kRefused);
    refusal.put(refused.where);
    refusal.put(refused.got);
    refusal.put(refused.want);
  } catch (...) {
    _exit(1);
  }
  _exit(std::fflush(file) == 0 ? 0 : 1);
}

std::string ended_how(int status) {
  if (!WIFSIGNALED(status)) return "";
  return std::string(" (") + strsignal(WTERMSIG(status)) + ")";
}

class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() {
    if (id_ > 0) {
      kill(id_, SIGKILL);
      (void)wait();
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return status;
  }

 private:
  pid_t id_;
};

}  // namespace

void Wire::put_bytes(const void* bytes, std::size_t count) {
  if (!begun_) {
    begun_ = true;
    put(mark_);
  }
  if (count > 0 && std::fwrite(bytes, 1, count, file_) != count) {
    throw std::runtime_error("the pipe is closed");
  }
}

void Wire::get_bytes(void* bytes, std::size_t count) {
  if (count > 0 && std::fread(bytes, 1, count, file_) != count) {
    throw std::runtime_error("the pipe has ended");
  }
}

void Wire::put(std::uint64_t number) { put_bytes(&number, sizeof number); }
void Wire::put(double number) { put_bytes(&number, sizeof number); }
void Wire::put(const std::string& text) {
  put(std::uint64_t{text.size()});
  put_bytes(text.data(), text.size());
}
void Wire::put(const std::vector<double>& numbers) {
  put(std::uint64_t{numbers.size()});
  put_bytes(numbers.data(), numbers.size() * sizeof(double));
}

std::uint64_t Wire::get_count(std::uint64_t most) {
  std::uint64_t number = 0;
  get_bytes(&number, sizeof number);
  if (number > most) throw std::runtime_error("a length that is too large");
  return number;
}
double Wire::get_number() {
  double number = 0.0;
  get_bytes(&number, sizeof number);
  return number;
}
std::string Wire::get_text() {
  std::string text(get_count(kLongestText), '\0');
  get_bytes(text.data(), text.size());
  return text;
}
std::vector<double> Wire::get_numbers(std::uint64_t most) {
  std::vector<double> numbers(get_count(most));
  get_bytes(numbers.data(), numbers.size() * sizeof(double));
  return numbers;
}

void in_child(const std::string& path, const std::function<void(Wire&)>& work,
              const std::function<void(Wire&)>& take) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "pipe2");
  }
  const pid_t own = getpid();
  const pid_t id = fork();
  if (id < 0) {
    const int error = errno;
    close(ends[0]);
    close(ends[1]);
    throw std::system_error(error, std::generic_category(), "fork");
  }
  if (id == 0) {
    close(ends[0]);
    run_child(own, ends[1], path, work);
  }
  close(ends[1]);
  Child child(id);
  const File file = opened(ends[0], "rb");
  Wire wire(file.get(), kDone);
  try {
    if (wire.get_count(kRefused) == kRefused) {
      const std::string where = wire.get_text();
      const std::string got = wire.get_text();
      throw ConfigError(where, got, wire.get_text());
    }
    take(wire);
  } catch (const std::runtime_error& error) {
    if (dynamic_cast<const ConfigError*>(&error) != nullptr) throw;
    const std::string how = ended_how(child.wait());
    throw ConfigError(path, "a file that its library cannot read to the end" + how,
                      "a whole file: it is damaged, or cut off");
  }
}

}  // namespace stillhand::measurement
