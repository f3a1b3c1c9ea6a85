// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/progress.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

namespace stillhand::report::progress_test {

using testing::HasSubstr;

/// A pseudo terminal as standard error while `action` runs.  @returns what it shows
std::string on_a_terminal(const std::function<void()>& action) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) return "no terminal";
  const int slave = open(ptsname(master), O_RDWR | O_NOCTTY);
  const int before = dup(STDERR_FILENO);
  std::fflush(stderr);
  dup2(slave, STDERR_FILENO);
  action();
  std::fflush(stderr);
  dup2(before, STDERR_FILENO);
  close(before);
  std::string shown;
  pollfd readable{master, POLLIN, 0};
  for (char block[4096]; poll(&readable, 1, 0) == 1 && (readable.revents & POLLIN) != 0;) {
    const ssize_t count = read(master, block, sizeof(block));
    if (count <= 0) break;
    shown.append(block, static_cast<std::size_t>(count));
  }
  close(slave);
  close(master);
  return shown;
}

TEST(ProgressLineTest, InAPipeItPrintsNothing) {
  testing::internal::CaptureStderr();
  ProgressLine sut;
  sut.show("fit", 0.0);
  sut.show("fit", 1.0);
  sut.show("draw", 0.5);
  sut.finish();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ProgressLineTest, OnATerminalTheBarIsAsFullAsTheStepIsDone) {
  const std::string shown = on_a_terminal([] {
    ProgressLine sut;
    sut.show("fit", 0.5);
    sut.show("fit", 1.0);
  });
  if (shown == "no terminal") GTEST_SKIP() << shown;
  EXPECT_THAT(shown, HasSubstr("[===============               ]  50 %"));
  EXPECT_THAT(shown, HasSubstr("[==============================] 100 %"));
  EXPECT_EQ(std::ranges::count(shown, '\n'), 1) << "drawn again and again, and ended once";
}

TEST(ProgressLineTest, TheSamePercentageIsNotDrawnAgain) {
  const std::string shown = on_a_terminal([] {
    ProgressLine sut;
    for (int i = 0; i < 100; ++i) sut.show("fit", 0.25 + i * 1e-5);
  });
  if (shown == "no terminal") GTEST_SKIP() << shown;
  EXPECT_EQ(std::ranges::count(shown, '%'), 1);
}

TEST(ProgressLineTest, EachStepHasALineOfItsOwnAndFinishEndsItOnce) {
  const std::string shown = on_a_terminal([] {
    ProgressLine sut;
    sut.finish();
    sut.show("fit", 1.0);
    sut.show("draw", 0.0);
    sut.finish();
    sut.finish();
  });
  if (shown == "no terminal") GTEST_SKIP() << shown;
  EXPECT_EQ(std::ranges::count(shown, '\n'), 2);
  EXPECT_LT(shown.find("fit"), shown.find('\n'));
  EXPECT_GT(shown.find("draw"), shown.find('\n'));
}

}  // namespace stillhand::report::progress_test
