// SPDX-License-Identifier: Apache-2.0
#include "apps/stop/running_sessions.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "apps/lab/domain_lock.hpp"
#include "apps/stop/socket_owners.hpp"

namespace stillhand::stop::running_sessions_test {
namespace {

// proc(5): number, references, protocol, flags, type, state, inode, path.
constexpr std::uint64_t kInode = 91234;

std::vector<RunningSession> found_in(const std::string& paths,
                                     const std::map<std::uint64_t, uid_t>& owners = {}) {
  std::string text = "Num       RefCount Protocol Flags    Type St Inode Path\n";
  std::istringstream lines(paths);
  std::uint64_t inode = kInode;
  for (std::string path; std::getline(lines, path);) {
    text += "0000000000000000: 00000002 00000000 00000000 0002 01 " + std::to_string(inode++) +
            ' ' + path + '\n';
  }
  std::istringstream sockets(text);
  return running_sessions(sockets, owners);
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
                       "@another-stillhand-lab\n@stillhand-lab-233-1\n@stillhand-lab-999-1\n")
                  .empty());
}

TEST(RunningSessionsTest, AUserWhoClaimsManyIsNotAskedBeforeOthers) {
  const std::vector<RunningSession> wanted{{3, 1}, {7, 1}, {3, 2}, {4, 1}};
  EXPECT_EQ(found_in("@stillhand-lab-4-1\n@stillhand-lab-3-1\n@stillhand-lab-3-2\n"
                     "@stillhand-lab-7-1\n",
                     {{kInode, 1000}, {kInode + 1, 1000}, {kInode + 2, 1000}, {kInode + 3, 1001}}),
            wanted);
}

TEST(RunningSessionsTest, TheKernelKnowsTheOwnerOfASocket) {
  const lab::DomainLock lock(229, 4'000'008);
  std::ifstream sockets("/proc/net/unix");
  std::string line;
  while (std::getline(sockets, line) && line.find("-229-4000008") == std::string::npos) continue;
  std::istringstream words(line);
  const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
  const auto owners = socket_owners();
  if (owners.empty()) GTEST_SKIP() << "no unix_diag here";
  EXPECT_EQ(owners.at(std::stoull(fields.at(6))), getuid());
}

// The names that the lab gives its locks, as the kernel lists them.
TEST(RunningSessionsTest, FindsTheLockOfALab) {
  constexpr std::uint32_t kDomain = 229, kRig = 4'000'007;
  const auto there = [] {
    std::ifstream sockets("/proc/net/unix");
    const auto sessions = running_sessions(sockets, socket_owners());
    return std::ranges::find(sessions, RunningSession{kDomain, kRig}) != sessions.end();
  };
  {
    const lab::DomainLock lock(kDomain, kRig);
    EXPECT_TRUE(there());
  }
  EXPECT_FALSE(there());
}

}  // namespace
}  // namespace stillhand::stop::running_sessions_test
