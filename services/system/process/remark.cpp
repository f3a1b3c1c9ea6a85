// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/remark.hpp"

#include <fstream>
#include <iostream>
#include <iterator>

namespace stillhand::runtime {

std::string prefix_of(std::string_view command_line) {
  const std::string_view words = command_line.substr(command_line.find('\0') + 1);
  const std::string_view verb = words.substr(0, words.find('\0'));
  const bool typed =
      command_line.find('\0') != std::string_view::npos && !verb.empty() && verb.front() != '-';
  return typed ? "stillhand " + std::string(verb) : "stillhand";
}

void remark(std::string_view text) {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string words{std::istreambuf_iterator<char>(file), {}};
  std::cerr << prefix_of(words) + ": " + std::string(text) + "\n";
}

}  // namespace stillhand::runtime
