// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "services/system/process/real_time.hpp"

namespace stillhand::runtime::end_with_parent_test {
namespace {

/// How a child ends that is told of this parent.
int end_of_child(pid_t parent) {
  const pid_t child = fork();
  if (child == 0) {
    end_with_parent(parent);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

// One that ended before the child asked for its signal sends none.
TEST(EndWithParentTest, AParentThatHasEndedAlreadyEndsTheChild) {
  const int status = end_of_child(getppid());  // another process has taken the child over
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
}

TEST(EndWithParentTest, AChildOfALivingParentGoesOn) { EXPECT_EQ(end_of_child(getpid()), 0); }

}  // namespace
}  // namespace stillhand::runtime::end_with_parent_test
