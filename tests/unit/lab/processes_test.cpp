// SPDX-License-Identifier: Apache-2.0
// The processes are shells.
#include "apps/lab/processes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/wait.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::lab::processes_test {
namespace {

using deploy::SampleFolder;
using support::text_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

class ProcessesTest : public testing::Test {
 protected:
  [[nodiscard]] Launch shell(const std::string& name, const std::string& script) const {
    Launch launch;
    launch.name = name;
    launch.executable = "/bin/sh";
    launch.arguments = {"-c", script};
    launch.log = folder_.path() / (name + ".log");
    return launch;
  }
  /// The next process that ends.
  Ended reaped() {
    std::optional<Ended> ended;
    EXPECT_TRUE(support::eventually([&] { return (ended = sut_.reap()).has_value(); }));
    return ended.value_or(Ended{});
  }
  /// Waits until a script has reported its process number in this file.
  static pid_t pid_in(const fs::path& file) {
    EXPECT_TRUE(support::eventually([&] { return text_of(file).ends_with('\n'); }));
    return static_cast<pid_t>(std::stol(text_of(file)));
  }
  static bool runs(pid_t pid) { return kill(pid, 0) == 0; }

  SampleFolder folder_;
  Processes sut_;
};

TEST_F(ProcessesTest, AnEndIsReportedOnceWithItsStatusAndLastLine) {
  sut_.start(shell("rig", "echo first; echo 'rig.yaml:1: wrong' >&2; echo; exit 2"));
  const Ended ended = reaped();
  EXPECT_EQ(ended.name, "rig");
  EXPECT_EQ(ended.exit_status, 2);
  EXPECT_EQ(ended.said, "rig.yaml:1: wrong");  // the last that is not empty
  EXPECT_EQ(describe(ended), "rig (pid " + std::to_string(ended.pid) +
                                 ") ended: exit status 2; it said: rig.yaml:1: wrong");
  EXPECT_FALSE(sut_.reap().has_value());
}

TEST_F(ProcessesTest, ASignalIsReportedByNumberAndName) {
  sut_.start(shell("motion", "kill -9 $$"));
  const Ended ended = reaped();
  EXPECT_EQ(ended.how, "signal 9 (Killed)");
  EXPECT_EQ(ended.exit_status, -1);
  EXPECT_THAT(ended.said, IsEmpty());
}

TEST(DescribeTest, WhatIsNotKnownIsLeftOut) {
  EXPECT_EQ(describe({"rig on desk", 0, "its life sign is gone", -1, ""}),
            "rig on desk ended: its life sign is gone");
}

TEST_F(ProcessesTest, AProcessOfAnotherHostIsNamedWithIt) {
  Launch launch = shell("rig", "exit 0");
  launch.host = "desk";
  sut_.start(launch);
  EXPECT_EQ(reaped().name, "rig on desk");
}

TEST_F(ProcessesTest, AMissingProgramIsNamedBeforeItIsStarted) {
  Launch launch = shell("rig", "");
  launch.executable = "/no/such/stillhand-rig";
  EXPECT_THAT(support::refusal([&] { sut_.start(launch); }),
              AllOf(HasSubstr("rig"), HasSubstr("/no/such/stillhand-rig")));
  EXPECT_FALSE(sut_.reap().has_value());
}

TEST_F(ProcessesTest, OutputAndErrorsAreApartWhereAFileIsNamedForTheOutput) {
  Launch launch = shell("rig", "echo out; echo error >&2");
  launch.output = folder_.path() / "out";
  sut_.start(launch);
  EXPECT_EQ(reaped().said, "error");
  EXPECT_EQ(text_of(launch.output), "out\n");
}

// Larger than a pipe holds at first (64 KiB): nobody reads before the process runs.
TEST_F(ProcessesTest, AProcessReadsItsTextToTheEndOfFile) {
  Launch launch = shell("rig", "wc -c");
  launch.standard_input = std::string(200'000, 'x');
  sut_.start(launch);
  EXPECT_EQ(std::stol(reaped().said), 200'000);
}

TEST_F(ProcessesTest, AProcessThatEndsWithItsInputIsAskedToEndByItsClosing) {
  Launch launch = shell("rig", "trap '' TERM; cat > " + (folder_.path() / "read").string());
  launch.standard_input = "text";
  launch.ends_with_input = true;
  sut_.start(launch);
  ASSERT_TRUE(support::eventually([&] { return text_of(folder_.path() / "read") == "text"; }));
  EXPECT_FALSE(sut_.reap().has_value());  // it waits for more
  sut_.end("rig", 20.0);
  EXPECT_FALSE(sut_.reap().has_value());  // its end was asked for: no report
}

TEST_F(ProcessesTest, AProcessThatDoesNotEndWhenAskedIsKilled) {
  const fs::path number = folder_.path() / "number";
  sut_.start(shell("rig", "trap '' TERM; echo $$ > " + number.string() + "; exec sleep 60"));
  const pid_t pid = pid_in(number);
  EXPECT_TRUE(runs(pid));
  sut_.end("rig", 0.01);
  EXPECT_FALSE(runs(pid));
}

TEST_F(ProcessesTest, TheOneNamedEndsAfterAllOthers) {
  const fs::path order = folder_.path() / "order";
  for (const std::string name : {"recorder", "rig", "motion"}) {
    sut_.start(shell(name, "trap 'echo " + name + " >> " + order.string() +
                               "; exit 0' TERM; echo ready; while :; do sleep 0.01; done"));
  }
  for (const std::string name : {"recorder", "rig", "motion"}) {
    ASSERT_TRUE(support::eventually(
        [&] { return text_of(folder_.path() / (name + ".log")) == "ready\n"; }));
  }
  sut_.end_all("recorder", 20.0);
  const std::string ended = text_of(order);
  EXPECT_THAT(ended, AllOf(HasSubstr("rig\n"), HasSubstr("motion\n")));
  EXPECT_TRUE(ended.ends_with("recorder\n")) << ended;
  EXPECT_EQ(ended.find("recorder"), ended.size() - std::string("recorder\n").size());
}

TEST_F(ProcessesTest, NoProcessOutlivesTheSession) {
  const fs::path number = folder_.path() / "number";
  pid_t pid = 0;
  {
    Processes sut;
    sut.start(shell("rig", "trap '' TERM; echo $$ > " + number.string() + "; exec sleep 60"));
    pid = pid_in(number);
  }
  EXPECT_FALSE(runs(pid));
}

// Ctrl-C in the terminal reaches a group: the lab's, and no process's.
TEST_F(ProcessesTest, EachProcessIsAGroupOfItsOwn) {
  const fs::path number = folder_.path() / "number";
  sut_.start(shell("rig", "echo $$ > " + number.string() + "; exec sleep 60"));
  const pid_t pid = pid_in(number);
  EXPECT_EQ(getpgid(pid), pid);
  EXPECT_NE(getpgrp(), pid);
}

}  // namespace
}  // namespace stillhand::lab::processes_test
