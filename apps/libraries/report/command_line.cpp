// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/command_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <string_view>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report {

std::string quoted_for_shell(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
  const bool plain = !word.empty() && word.find_first_not_of(kPlain) == std::string::npos;
  return plain ? word : in_shell_quotes(word);
}

std::string in_shell_quotes(std::string word) {
  replace_all(word, "'", "'\\''");
  return "'" + word + "'";
}

std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string text = "stillhand";
  std::string word;
  std::getline(file, word, '\0');  // the program's own name
  while (std::getline(file, word, '\0')) text += " " + quoted_for_shell(word);
  return text;
}

void say_next(const std::string& step) {
  if (isatty(STDOUT_FILENO) == 1) fmt::print("next: {}\n", step);
}

void say_open(const std::filesystem::path& file) { say_next("open " + quoted_for_shell(file)); }

void say_report(const std::filesystem::path& folder) {
  fmt::print("report in {}\n", folder.string());
  say_open(folder / "report.html");
}

}  // namespace stillhand::report
