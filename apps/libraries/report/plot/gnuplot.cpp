// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/gnuplot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "services/core/contract/config_error.hpp"

extern char** environ;

namespace stillhand::report {
namespace {

// Descriptors of the outputs in the child: 0 to 2 are the standard ones.
constexpr int kFirstOutput = 3;

// An anonymous file in memory.  Unlike a pipe it cannot fill up, and it leaves no file behind.
class MemoryFile {
 public:
  // fcntl moves the descriptor above those of the child, so that no dup2 in the child overwrites a
  // descriptor that is still needed.
  explicit MemoryFile(int above) {
    const int low = memfd_create("stillhand-report", MFD_CLOEXEC);
    if (low < 0) throw std::system_error(errno, std::generic_category(), "memory for gnuplot");
    descriptor_ = fcntl(low, F_DUPFD_CLOEXEC, above);
    const int error = errno;
    close(low);
    if (descriptor_ < 0) {
      throw std::system_error(error, std::generic_category(), "memory for gnuplot");
    }
  }
  ~MemoryFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  MemoryFile(MemoryFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  MemoryFile& operator=(MemoryFile&&) = delete;
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }

  void put(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t count = write(descriptor_, text.data(), text.size());
      if (count < 0 && errno != EINTR) {
        throw std::system_error(errno, std::generic_category(), "memory for gnuplot");
      }
      if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    }
    lseek(descriptor_, 0, SEEK_SET);
  }

  [[nodiscard]] std::string content() const {
    std::string text;
    std::array<char, 65536> buffer;
    ssize_t count = 0;
    while ((count = pread(descriptor_, buffer.data(), buffer.size(),
                          static_cast<off_t>(text.size()))) > 0) {
      text.append(buffer.data(), static_cast<std::size_t>(count));
    }
    if (count < 0) throw std::system_error(errno, std::generic_category(), "memory of gnuplot");
    return text;
  }

 private:
  int descriptor_ = -1;
};

// The caller's environment without its locale and gnuplot's variables.  C.UTF-8 is C with letters
// beyond ASCII; every Debian has it.
std::vector<std::string> environment() {
  std::vector<std::string> variables{"LC_ALL=C.UTF-8"};
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view variable = *entry;
    const bool unwanted = variable.starts_with("LC_") || variable.starts_with("LANG") ||
                          variable.starts_with("GNUPLOT") || variable.starts_with("GNUTERM");
    if (!unwanted) variables.emplace_back(variable);
  }
  return variables;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> result;
  result.reserve(words.size() + 1);
  for (std::string& word : words) result.push_back(word.data());
  result.push_back(nullptr);
  return result;
}

class SpawnSettings {
 public:
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_init(&attributes_);
    // Only the caller reacts to Ctrl-C: gnuplot is in its own process group, and ends when it has
    // drawn or the caller kills it.  Signals that the caller blocks are not blocked in gnuplot.
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

// The end of gnuplot's message, which holds the reason, on one line.
std::string last_words(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const char plain = c == '\n' || c == '\r' || c == '\t' ? ' ' : c;
    if (plain != ' ' || (!line.empty() && line.back() != ' ')) line += plain;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  constexpr std::size_t kEnough = 200;
  return line.size() > kEnough ? "... " + line.substr(line.size() - kEnough) : line;
}

// One gnuplot process.  The destructor kills and reaps it if an exception interrupts the work.
class Gnuplot {
 public:
  explicit Gnuplot(const GnuplotJob& job)
      : above_(kFirstOutput + job.outputs), input_(above_), errors_(above_) {
    input_.put(job.script);
    for (int i = 0; i < job.outputs; ++i) outputs_.emplace_back(above_);
    spawn();
  }
  ~Gnuplot() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Gnuplot(Gnuplot&& other) noexcept
      : above_(other.above_),
        input_(std::move(other.input_)),
        errors_(std::move(other.errors_)),
        outputs_(std::move(other.outputs_)),
        pid_(std::exchange(other.pid_, 0)) {}
  Gnuplot& operator=(Gnuplot&&) = delete;
  Gnuplot(const Gnuplot&) = delete;
  Gnuplot& operator=(const Gnuplot&) = delete;

  std::vector<std::string> finish() {
    const int status = reap();
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      const std::string how = WIFSIGNALED(status)
                                  ? std::string("signal ") + sigdescr_np(WTERMSIG(status))
                                  : "exit status " + std::to_string(WEXITSTATUS(status));
      throw std::runtime_error(
          "gnuplot: ended with " + how +
          ", want exit status 0; its message: " + last_words(errors_.content()));
    }
    std::vector<std::string> contents;
    for (const MemoryFile& output : outputs_) contents.push_back(output.content());
    return contents;
  }

 private:
  void spawn() {
    SpawnSettings settings;
    const auto connect = [&](int from, int to) {
      posix_spawn_file_actions_adddup2(&settings.actions_, from, to);
    };
    connect(input_.descriptor(), STDIN_FILENO);
    posix_spawn_file_actions_addopen(&settings.actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    connect(errors_.descriptor(), STDERR_FILENO);
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      connect(outputs_[i].descriptor(), kFirstOutput + static_cast<int>(i));
    }
    std::vector<std::string> words{"gnuplot", "--default-settings", "-"};
    std::vector<std::string> variables = environment();
    const int error = posix_spawnp(&pid_, "gnuplot", &settings.actions_, &settings.attributes_,
                                   pointers(words).data(), pointers(variables).data());
    if (error == 0) return;
    pid_ = 0;
    throw ConfigError("gnuplot", std::generic_category().message(error),
                      "the program on the PATH (Debian package gnuplot-nox; deploy/setup.sh "
                      "installs it)");
  }

  int reap() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0) {
      if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "gnuplot");
    }
    pid_ = 0;
    return status;
  }

  int above_;
  MemoryFile input_;
  MemoryFile errors_;
  std::vector<MemoryFile> outputs_;
  pid_t pid_ = 0;
};

}  // namespace

std::string output_path(int n) { return "/dev/fd/" + std::to_string(kFirstOutput + n); }

std::vector<std::vector<std::string>> run_gnuplot(std::span<const GnuplotJob> jobs) {
  std::vector<Gnuplot> running;
  running.reserve(jobs.size());
  for (const GnuplotJob& job : jobs) running.emplace_back(job);
  std::vector<std::vector<std::string>> results;
  results.reserve(jobs.size());
  for (Gnuplot& gnuplot : running) results.push_back(gnuplot.finish());
  return results;
}

}  // namespace stillhand::report
