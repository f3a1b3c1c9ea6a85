// SPDX-License-Identifier: Apache-2.0
#include "apps/stop/running_sessions.hpp"

#include <algorithm>
#include <string>
#include <tuple>

namespace stillhand::stop {
namespace {

/// Digits up to the end or to `separator`; removes them.  False where there are none.
bool take_number(std::string& text, std::uint32_t& number) {
  constexpr std::size_t kMostDigits = 9;
  const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  if (end == 0 || end > kMostDigits) return false;
  number = static_cast<std::uint32_t>(std::stoul(text.substr(0, end)));
  text.erase(0, end);
  return true;
}

}  // namespace

std::vector<RunningSession> running_sessions(std::istream& sockets) {
  const std::string mark = "@stillhand-lab-";
  std::vector<RunningSession> sessions;
  for (std::string line; std::getline(sockets, line);) {
    const std::size_t found = line.rfind(mark);
    if (found == std::string::npos) continue;
    std::string rest = line.substr(found + mark.size());
    RunningSession session;
    if (!take_number(rest, session.domain) || !rest.starts_with('-')) continue;
    rest.erase(0, 1);
    if (!take_number(rest, session.rig) || !rest.empty()) continue;
    sessions.push_back(session);
  }
  std::ranges::sort(sessions, {}, [](const RunningSession& session) {
    return std::tuple(session.domain, session.rig);
  });
  const auto same = std::ranges::unique(sessions);
  sessions.erase(same.begin(), same.end());
  return sessions;
}

}  // namespace stillhand::stop
