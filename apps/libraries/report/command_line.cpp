// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/command_line.hpp"

#include <fstream>
#include <string_view>

namespace stillhand::report {

std::string quoted_for_shell(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char each : word) text += each == '\'' ? std::string("'\\''") : std::string(1, each);
  return text + "'";
}

std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string text = "stillhand";
  std::string word;
  std::getline(file, word, '\0');  // the program's own name
  while (std::getline(file, word, '\0')) text += " " + quoted_for_shell(word);
  return text;
}

}  // namespace stillhand::report
