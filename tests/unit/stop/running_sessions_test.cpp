// SPDX-License-Identifier: Apache-2.0
#include "apps/stop/running_sessions.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "apps/lab/domain_lock.hpp"

namespace stillhand::stop {
namespace {

// proc(5): number, references, protocol, flags, type, state, inode, path.
std::vector<RunningSession> found_in(const std::string& paths) {
  std::string text = "Num       RefCount Protocol Flags    Type St Inode Path\n";
  std::istringstream lines(paths);
  for (std::string path; std::getline(lines, path);) {
    text += "0000000000000000: 00000002 00000000 00000000 0002 01 91234 " + path + '\n';
  }
  std::istringstream sockets(text);
  return running_sessions(sockets);
}

TEST(RunningSessionsTest, EveryLabOfTheMachineIsFoundOnceInTheOrderOfDomains) {
  const std::vector<RunningSession> wanted{{0, 1}, {7, 1}, {7, 2}, {232, 4294}};
  EXPECT_EQ(
      found_in("@stillhand-lab-232-4294\n/run/dbus\n@stillhand-lab-7-2\n\n@stillhand-lab-7-1\n"
               "@stillhand-lab-7-2\n@stillhand-lab-0-1\n"),
      wanted);
}

TEST(RunningSessionsTest, OtherSocketsAreNoSessions) {
  EXPECT_TRUE(found_in("@stillhand-lab-\n@stillhand-lab-7\n@stillhand-lab-7-\n@stillhand-lab-7-1x\n"
                       "@stillhand-lab--1\n@stillhand-lab-99999999999-1\n/tmp/stillhand-lab-7-1\n"
                       "@another-stillhand-lab\n")
                  .empty());
}

// The names that the lab gives its locks, as the kernel lists them.
TEST(RunningSessionsTest, FindsTheLockOfALab) {
  constexpr std::uint32_t kDomain = 229, kRig = 4'000'007;
  const auto there = [] {
    std::ifstream sockets("/proc/net/unix");
    const auto sessions = running_sessions(sockets);
    return std::ranges::find(sessions, RunningSession{kDomain, kRig}) != sessions.end();
  };
  {
    const lab::DomainLock lock(kDomain, kRig);
    EXPECT_TRUE(there());
  }
  EXPECT_FALSE(there());
}

}  // namespace
}  // namespace stillhand::stop
