// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::support {

/// add_record_command() and its like.
using AddVerb = void (*)(command_line::Command&, int&);

/// Runs a verb in this process.
/// @param words  its name first
/// @return its exit status
/// @throws ConfigError, command_line::UsageError as the verb
inline int run_verb(AddVerb add, std::vector<std::string> words) {
  command_line::Program cli;
  int status = -1;
  add(cli, status);
  cli.parse(std::move(words));
  return status;
}

/// @return why the verb refuses the words; "status N": it does not
inline std::string refusal_of(AddVerb add, const std::vector<std::string>& words) {
  try {
    return "status " + std::to_string(run_verb(add, words));
  } catch (const ConfigError& error) {
    return error.what();
  } catch (const command_line::UsageError& error) {
    return std::string("command line: ") + error.what();
  }
}

/// @return what the verb prints; its status has to be 0
/// @throws as run_verb()
inline std::string output_of(AddVerb add, const std::vector<std::string>& words) {
  testing::internal::CaptureStdout();
  try {
    EXPECT_EQ(run_verb(add, words), 0);
  } catch (...) {
    testing::internal::GetCapturedStdout();
    throw;
  }
  std::fflush(stdout);
  return testing::internal::GetCapturedStdout();
}

/// A verb's name, then its words.
inline std::vector<std::string> named(const char* verb, std::vector<std::string> words) {
  words.insert(words.begin(), verb);
  return words;
}

}  // namespace stillhand::support
