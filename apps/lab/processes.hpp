// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stillhand::lab {

/// One process to start.
struct Launch {
  std::string name;                    ///< service
  std::filesystem::path executable;    ///< without a folder: looked for in PATH
  std::vector<std::string> arguments;  ///< without the program's name
  std::filesystem::path log;           ///< standard output and error go here
  std::filesystem::path output;        ///< standard output alone; empty: to the log too
  std::string standard_input;          ///< text that it reads there, before the end of file
  std::string host;                    ///< where it runs; empty: this machine
  bool ends_with_input = false;        ///< it stays open; its closing asks the process to end
};

/// How a process ended.
struct Ended {
  std::string name;  ///< "rig", "rig on desk"
  pid_t pid;         ///< 0: not known on this machine
  std::string how;   ///< "exit status 2", "signal 9 (Killed)"
  int exit_status;   ///< -1 after a signal
  std::string said;  ///< last line of its log
};

/// "rig (pid 7) ended: signal 9 (Killed); it said: ..."
std::string describe(const Ended& ended);

/// The processes of a session: each in a process group of its own (Ctrl-C reaches the lab alone),
/// and each ends when the lab does.  One thread.
class Processes {
 public:
  Processes() = default;
  /// Kills every process that still runs.
  ~Processes();
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  /// @throws ConfigError when the executable is missing; std::system_error when it cannot start.
  void start(const Launch& launch);
  /// One that ended since the last call, or nothing; does not wait.
  std::optional<Ended> reap();
  /// Asks one to end and waits; kills it after `patience_s` [s].
  void end(const std::string& name, double patience_s);
  /// Asks all but `last` to end, waits, then ends `last`: the recorder sees the others out.
  void end_all(const std::string& last, double patience_s);

 private:
  struct Child {
    Launch launch;
    pid_t pid;
    int input;  ///< our end of its standard input; -1: closed
  };
  static void ask_to_end(Child& child);
  void signal_and_wait(const std::vector<std::string>& names, double patience_s);
  Ended ended(const Child& child, int wait_status) const;

  std::vector<Child> children_;
};

}  // namespace stillhand::lab
