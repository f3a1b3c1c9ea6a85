// SPDX-License-Identifier: Apache-2.0
#include "apps/stop/running_sessions.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <tuple>

#include "services/system/process/domain.hpp"

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

std::vector<RunningSession> running_sessions(std::istream& sockets,
                                             const std::map<std::uint64_t, uid_t>& owners) {
  const std::string mark = "@stillhand-lab-";
  std::map<uid_t, std::set<RunningSession>> claims;
  for (std::string line; std::getline(sockets, line);) {
    const std::size_t found = line.rfind(mark);
    if (found == std::string::npos) continue;
    std::string rest = line.substr(found + mark.size());
    RunningSession session;
    if (!take_number(rest, session.domain) || !rest.starts_with('-')) continue;
    rest.erase(0, 1);
    if (!take_number(rest, session.rig) || !rest.empty()) continue;
    if (session.domain > runtime::kMaxDomain) continue;  // no lab has it
    // Behind six other words, proc(5).
    std::istringstream words(line.substr(0, found));
    const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
    const auto owner =
        owners.find(fields.size() == 7 ? std::strtoull(fields[6].c_str(), nullptr, 10) : 0);
    claims[owner == owners.end() ? 0 : owner->second].insert(session);
  }
  std::vector<std::tuple<std::size_t, RunningSession>> turns;
  for (const auto& [user, sessions] : claims) {
    std::size_t turn = 0;
    for (const RunningSession& session : sessions) turns.emplace_back(turn++, session);
  }
  std::ranges::sort(turns);
  std::vector<RunningSession> all;
  for (const auto& [turn, session] : turns) {
    if (std::ranges::find(all, session) == all.end()) all.push_back(session);
  }
  return all;
}

}  // namespace stillhand::stop
