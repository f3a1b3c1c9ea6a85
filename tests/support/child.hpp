// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/folder.hpp"

namespace stillhand::support {

/// A program whose standard output goes into a file; asked to end, and waited for, by finish() or
/// its destructor.
class Child {
 public:
  /// @param environment  "NAME=value" on top of this process's
  Child(std::vector<std::string> arguments, std::filesystem::path output,
        const std::vector<std::string>& environment = {})
      : output_(std::move(output)) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output_.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    std::vector<std::string> variables = environment;
    for (char** inherited = environ; *inherited != nullptr; ++inherited) {
      variables.emplace_back(*inherited);
    }
    std::vector<char*> envp;
    for (std::string& variable : variables) envp.push_back(variable.data());
    envp.push_back(nullptr);
    const int error = posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), envp.data());
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error("cannot start " + arguments.front());
  }
  ~Child() { finish(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// SIGTERM, without waiting: many end sooner when all were asked first.
  void ask_to_end() const {
    if (pid_ > 0) kill(pid_, SIGTERM);
  }
  /// SIGTERM, then its end.  @returns its exit status, or -1
  int finish() {
    if (pid_ <= 0) return status_;
    ask_to_end();
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return status_;
  }
  [[nodiscard]] std::string output() const { return text_of(output_); }

 private:
  std::filesystem::path output_;
  pid_t pid_ = 0;
  int status_ = -1;
};

}  // namespace stillhand::support
