// SPDX-License-Identifier: Apache-2.0
// Each signal is sent to a process of its own, so that this one keeps its own signals.
#include "services/system/process/stop.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "tests/support/wait.hpp"

namespace stillhand::runtime::stop_test {
namespace {

/// Ends with 0 when the signal became a request.
[[noreturn]] void send(int signal) {
  const Stop sut;
  if (sut.requested()) _exit(2);
  kill(getpid(), signal);
  _exit(support::eventually([&] { return sut.requested(); }) ? 0 : 1);
}

TEST(StopDeathTest, ASignalBecomesARequest) {
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(send(signal), testing::ExitedWithCode(0), "") << signal;
  }
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_DFL);
        send(SIGHUP);
      },
      testing::ExitedWithCode(0), "");
}

// As nohup starts it: the end of the terminal is not its own.
TEST(StopDeathTest, AHangupThatIsIgnoredIsNoRequest) {
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_IGN);
        const Stop sut;
        kill(getpid(), SIGHUP);
        _exit(sut.requested() ? 1 : 0);
      },
      testing::ExitedWithCode(0), "");
}

TEST(StopDeathTest, AThreadThatWaitsGoesOnAtTheRequest) {
  EXPECT_EXIT(
      {
        const Stop sut;
        std::thread waiting([&] { sut.wait(); });
        kill(getpid(), SIGTERM);
        waiting.join();
        _exit(sut.requested() ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

// A reader that left (`stillhand record | head`) must not kill the process.
TEST(StopDeathTest, APipeWithoutAReaderIsAFailedWrite) {
  EXPECT_EXIT(
      {
        const Stop sut;
        int ends[2];
        if (pipe(ends) != 0) _exit(2);
        close(ends[0]);
        _exit(write(ends[1], "x", 1) == -1 ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

TEST(StopDeathTest, ARequestOfTheProgramItselfStaysAndEndsEveryWait) {
  EXPECT_EXIT(
      {
        Stop sut;
        sut.request();
        sut.request();
        sut.wait();
        sut.wait();
        _exit(sut.requested() ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

// A step that never looks at the flag.
TEST(EndAfterStopDeathTest, WorkThatDoesNotAnswerEndsTidied) {
  EXPECT_EXIT(
      {
        const Stop stop;
        const EndAfterStop sut(stop, [] { (void)!write(STDERR_FILENO, "tidied\n", 7); });
        kill(getpid(), SIGINT);
        for (;;) pause();
      },
      testing::ExitedWithCode(1), "interrupted\ntidied\n");
}

TEST(EndAfterStopDeathTest, WorkThatAnswersEndsByItself) {
  EXPECT_EXIT(
      {
        Stop stop;
        {
          const EndAfterStop sut(stop, [] { _exit(3); });
          stop.request();
        }
        _exit(0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace stillhand::runtime::stop_test
