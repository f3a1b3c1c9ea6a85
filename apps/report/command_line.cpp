// SPDX-License-Identifier: Apache-2.0
#include "apps/report/command_line.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace stillhand::report {

std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!text.empty()) text.pop_back();
  std::replace(text.begin(), text.end(), '\0', ' ');
  const auto space = text.find(' ');
  return "stillhand" + (space == std::string::npos ? std::string() : text.substr(space));
}

}  // namespace stillhand::report
