// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "apps/deploy/inventory.hpp"
#include "apps/lab/processes.hpp"
#include "services/runtime/process/stop.hpp"

namespace stillhand::lab {

/// Somebody asked for the end before there was anything to keep.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted before the first trial") {}
};

/// Another machine of the lab, reached by the words that its inventory gives (`ssh rig-pc`): a
/// shell there reads what to do from its standard input, so that nothing has to be quoted twice and
/// nothing but bash has to be there.
class RemoteHost {
 public:
  /// @param host  one with start words; outlives this
  /// @param log   what it says when something goes wrong there
  RemoteHost(const deploy::Host& host, std::filesystem::path log);

  /// Makes a folder there, for as long as the session lasts.
  /// @throws ConfigError when the host cannot be reached, Interrupted on a stop meanwhile
  void open(const runtime::Stop& stop);
  /// Takes the folder away again.  @throws std::runtime_error
  void close();
  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }
  [[nodiscard]] const deploy::Host& host() const noexcept { return host_; }

  /// Runs a script there that says what is wrong, if anything is, and fails.
  /// @throws ConfigError with its last line, and with what would be right
  void check(const std::string& script, const std::string& want);
  /// Writes text files into its folder.  @param files  path below the folder, text
  void put(const std::map<std::string, std::string>& files);
  /// Copies a file to a new one here.  @param name  absolute, or below its folder
  /// @throws std::runtime_error
  void fetch(const std::string& name, const std::filesystem::path& to);

  /// The same process there.  It ends when its standard input does: when the lab closes it, dies,
  /// or can no longer be reached.
  [[nodiscard]] Launch on_it(const Launch& local) const;

 private:
  /// Runs a script there, and gives it as long as it goes on printing.
  /// @param output  file for what it prints; empty: the log
  /// @param stop    ends it, too; none where what it does is to be done in any case
  void run(const std::string& script, const std::filesystem::path& output = {},
           const runtime::Stop* stop = nullptr);

  const deploy::Host& host_;
  std::filesystem::path log_;
  std::string folder_;
};

/// A word as a POSIX shell reads it back.
std::string shell_word(const std::string& word);

/// `<<'END'` and what follows, by which a command reads this text; a last line without an end gets
/// one.
std::string here_document(const std::string& text);

/// The folder that open()'s script has made, of all that a host printed; empty: none.
std::string folder_told(const std::string& printed);

}  // namespace stillhand::lab
