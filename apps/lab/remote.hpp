// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "apps/deploy/inventory.hpp"
#include "apps/lab/processes.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::lab {

/// The user interrupted the session before there was anything to keep.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted before the first trial") {}
};

/// Another machine of the lab, reached by the words that the inventory gives (`ssh rig-pc`).  A
/// shell there reads its script from its standard input: nothing has to be quoted twice, and the
/// machine needs only bash.
class RemoteHost {
 public:
  /// @param host  one with start words; outlives this
  /// @param log   gets the lines that its shell prints
  RemoteHost(const deploy::Host& host, std::filesystem::path log);

  /// Makes a folder there, for as long as the session lasts.
  /// @throws ConfigError when the host cannot be reached, Interrupted on a stop meanwhile
  void open(const runtime::Stop& stop);
  /// Removes that folder.  @throws std::runtime_error
  void close();
  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }
  [[nodiscard]] const deploy::Host& host() const noexcept { return host_; }

  /// Runs a script there that prints what is wrong and fails, or succeeds.
  /// @param want  what would be right
  /// @throws ConfigError with the script's last line
  void check(const std::string& script, const std::string& want);
  /// Writes text files into its folder.  @param files  path below the folder, text
  void put(const std::map<std::string, std::string>& files);
  /// Copies a file to a new one here.  @param name  absolute, or below its folder
  /// @throws std::runtime_error
  void fetch(const std::string& name, const std::filesystem::path& to);

  /// The same process on this host.  It ends when its standard input does: when the lab closes it,
  /// dies, or can no longer be reached.
  [[nodiscard]] Launch on_it(const Launch& local) const;

 private:
  /// Runs a script there, for as long as it prints something every 30 s.
  /// @param output  file for its standard output; empty: the log
  /// @param stop    also ends it; nullptr: the script runs to its end in any case
  void run(const std::string& script, const std::filesystem::path& output = {},
           const runtime::Stop* stop = nullptr);

  const deploy::Host& host_;
  std::filesystem::path log_;
  std::string folder_;
};

/// A here document (`<<'END'`) by which a command reads this text.  A last line without a newline
/// gets one.
std::string here_document(const std::string& text);

/// The folder that open()'s script made, from everything that the host printed; empty: none.
std::string folder_made(const std::string& printed);

}  // namespace stillhand::lab
