// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/processes.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/system/process/clock.hpp"

extern char** environ;

namespace stillhand::lab {
namespace {

constexpr std::int64_t kPollPeriod_ns = 5'000'000;

std::string last_line(const std::filesystem::path& log) {
  std::ifstream file(log);
  std::string line;
  std::string last;
  while (std::getline(file, line)) {
    if (!line.empty()) last = line;
  }
  return last;
}

class SpawnSettings {
 public:
  SpawnSettings(const Launch& launch, int standard_input) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, standard_input, STDIN_FILENO);
    add_file(STDERR_FILENO, launch.log);
    if (launch.output.empty()) {
      posix_spawn_file_actions_adddup2(&actions_, STDERR_FILENO, STDOUT_FILENO);
    } else {
      add_file(STDOUT_FILENO, launch.output);
    }
    posix_spawnattr_init(&attributes_);
    // The lab blocks the signals it waits for; its children start with none blocked.
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setpgroup(&attributes_, 0);
    // They do not inherit its priority: a service asks for its own, a copy over a network needs
    // none.
    const sched_param ordinary{};
    posix_spawnattr_setschedpolicy(&attributes_, SCHED_OTHER);
    posix_spawnattr_setschedparam(&attributes_, &ordinary);
    posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSCHEDULER);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  void add_file(int descriptor, const std::filesystem::path& file) {
    posix_spawn_file_actions_addopen(&actions_, descriptor, file.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
  }

  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

/// A pipe that gives a text and then ends.  Unlike arguments and environment, the text appears in
/// no listing of processes, and it is gone once it is read.
class TextToRead {
 public:
  explicit TextToRead(const std::string& text) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
      throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
    }
    end_ = ends[0];
    // All of it has to fit, as nobody reads yet.
    const auto size = static_cast<ssize_t>(text.size());
    if (fcntl(ends[1], F_GETPIPE_SZ) < size) fcntl(ends[1], F_SETPIPE_SZ, static_cast<int>(size));
    const bool written =
        size <= fcntl(ends[1], F_GETPIPE_SZ) && write(ends[1], text.data(), text.size()) == size;
    far_end_ = ends[1];
    if (!written) {
      close(end_);
      close(far_end_);
      throw std::runtime_error("cannot write to a pipe");
    }
  }
  ~TextToRead() {
    close(end_);
    if (far_end_ >= 0) close(far_end_);
  }
  TextToRead(const TextToRead&) = delete;
  TextToRead& operator=(const TextToRead&) = delete;

  [[nodiscard]] int end() const { return end_; }
  /// The end that this process holds: the reader sees the end of the text once it is closed.
  [[nodiscard]] int take_far_end() { return std::exchange(far_end_, -1); }

 private:
  int end_;
  int far_end_;
};

}  // namespace

std::string describe(const Ended& ended) {
  return fmt::format("{}{} ended: {}{}", ended.name,
                     ended.pid > 0 ? fmt::format(" (pid {})", ended.pid) : "", ended.how,
                     ended.said.empty() ? "" : "; it said: " + ended.said);
}

Processes::~Processes() {
  for (const Child& child : children_) {
    if (child.input >= 0) close(child.input);
    kill(child.pid, SIGKILL);
    waitpid(child.pid, nullptr, 0);
  }
}

void Processes::start(const Launch& launch) {
  if (launch.executable.has_parent_path() && access(launch.executable.c_str(), X_OK) != 0) {
    throw ConfigError("executable of " + launch.name, "no program " + launch.executable.string(),
                      "a complete build: every stillhand-* in the folder of stillhand");
  }
  std::vector<std::string> words{launch.executable.string()};
  words.insert(words.end(), launch.arguments.begin(), launch.arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  TextToRead input(launch.standard_input);
  const SpawnSettings settings(launch, input.end());
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, launch.executable.c_str(), &settings.actions_,
                                 &settings.attributes_, argv.data(), environ);
  if (error != 0) {
    throw std::system_error(error, std::generic_category(), "cannot start " + launch.name);
  }
  children_.push_back({launch, pid, launch.ends_with_input ? input.take_far_end() : -1});
  children_.back().launch.standard_input.clear();
}

Ended Processes::ended(const Child& child, int wait_status) const {
  const std::string& host = child.launch.host;
  Ended ended{child.launch.name + (host.empty() ? "" : " on " + host), child.pid, "", -1,
              last_line(child.launch.log)};
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    ended.how = fmt::format("signal {} ({})", signal, sigdescr_np(signal));
  } else {
    ended.exit_status = WEXITSTATUS(wait_status);
    ended.how = fmt::format("exit status {}", ended.exit_status);
  }
  return ended;
}

std::optional<Ended> Processes::reap() {
  for (auto child = children_.begin(); child != children_.end(); ++child) {
    int status = 0;
    if (waitpid(child->pid, &status, WNOHANG) == child->pid) {
      const Ended result = ended(*child, status);
      if (child->input >= 0) close(child->input);
      children_.erase(child);
      return result;
    }
  }
  return std::nullopt;
}

// A signal would end the connection to a process on another host, not the process.
void Processes::ask_to_end(Child& child) {
  if (child.input >= 0) {
    close(std::exchange(child.input, -1));
  } else {
    kill(child.pid, SIGTERM);
  }
}

void Processes::signal_and_wait(const std::vector<std::string>& names, double patience_s) {
  const auto named = [&](const Child& child) {
    return std::find(names.begin(), names.end(), child.launch.name) != names.end();
  };
  for (Child& child : children_) {
    if (named(child)) ask_to_end(child);
  }
  const std::int64_t limit_ns =
      runtime::monotonic_ns() + static_cast<std::int64_t>(patience_s * 1e9);
  bool killed = false;
  while (std::any_of(children_.begin(), children_.end(), named)) {
    std::erase_if(children_, [&](const Child& child) {
      return named(child) && waitpid(child.pid, nullptr, WNOHANG) == child.pid;
    });
    const std::int64_t now_ns = runtime::monotonic_ns();
    if (now_ns > limit_ns && !killed) {
      killed = true;
      for (const Child& child : children_) {
        if (named(child)) kill(child.pid, SIGKILL);
      }
    }
    runtime::sleep_until_ns(now_ns + kPollPeriod_ns);
  }
}

void Processes::end(const std::string& name, double patience_s) {
  signal_and_wait({name}, patience_s);
}

void Processes::end_all(const std::string& last, double patience_s) {
  std::vector<std::string> others;
  for (const Child& child : children_) {
    if (child.launch.name != last) others.push_back(child.launch.name);
  }
  signal_and_wait(others, patience_s);
  end(last, patience_s);
}

}  // namespace stillhand::lab
