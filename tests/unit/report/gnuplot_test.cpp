// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/gnuplot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/report/sample_figures.hpp"

namespace stillhand::report::gnuplot_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// The PATH that a case needs; the old one comes back.
class Path {
 public:
  explicit Path(const std::string& path) : old_(std::getenv("PATH")) {
    setenv("PATH", path.c_str(), 1);
  }
  ~Path() { setenv("PATH", old_.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

 private:
  std::string old_;
};

GnuplotJob printing(const std::string& text) {
  return {"set print '" + output_path(0) + "'\nprint " + text + "\n", 1};
}

std::string message_of(const GnuplotJob& job) {
  return support::refusal<std::runtime_error>([&] { run_gnuplot({&job, 1}); });
}

TEST(GnuplotTest, EachJobGetsItsOutputsBack) {
  GnuplotJob two = printing("'first'");
  two.script += "set print '" + output_path(1) + "'\nprint 'second'\n";
  two.outputs = 2;
  const std::vector<GnuplotJob> jobs{two, printing("'third'")};
  const auto sut = run_gnuplot(jobs);
  ASSERT_EQ(sut.size(), 2U);
  EXPECT_THAT(sut[0], ElementsAre("first\n", "second\n"));
  EXPECT_THAT(sut[1], ElementsAre("third\n"));
}

TEST(GnuplotTest, ManyOutputsDoNotGetIntoEachOthersWay) {
  GnuplotJob job;
  for (; job.outputs < 100; ++job.outputs) {
    job.script +=
        "set print '" + output_path(job.outputs) + "'\nprint " + std::to_string(job.outputs) + "\n";
  }
  const auto sut = run_gnuplot({&job, 1});
  for (int i = 0; i < job.outputs; ++i) {
    ASSERT_EQ(sut[0][static_cast<std::size_t>(i)], std::to_string(i) + "\n");
  }
}

TEST(GnuplotTest, AnErrorInAScriptIsOneLineWithGnuplotsReason) {
  const std::string sut = message_of({"set nonsense 1\n", 0});
  EXPECT_THAT(sut, HasSubstr("exit status 1"));
  EXPECT_THAT(sut, HasSubstr("unrecognized option"));
  EXPECT_THAT(sut, Not(HasSubstr("\n")));
}

TEST(GnuplotTest, AMissingProgramIsSaidWithThePackageThatHasIt) {
  const test::TemporaryFolder empty;
  const Path path(empty.path());
  const GnuplotJob job = printing("1");
  EXPECT_THROW(run_gnuplot({&job, 1}), ConfigError);
  EXPECT_THAT(message_of(job), HasSubstr("gnuplot-nox"));
}

TEST(GnuplotTest, AProgramThatDiesIsSaidWithItsSignal) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "gnuplot") << "#!/bin/sh\nkill -SEGV $$\n";
  std::filesystem::permissions(folder.path() / "gnuplot", std::filesystem::perms::owner_all);
  const Path path(folder.path());
  EXPECT_THAT(message_of(printing("1")), HasSubstr("Segmentation fault"));
}

TEST(GnuplotTest, NobodysSettingsOrLocaleChangeWhatIsDrawn) {
  const test::TemporaryFolder home;
  std::ofstream(home.path() / ".gnuplot") << "x = 'from a start-up file'\n";
  setenv("HOME", home.path().c_str(), 1);
  setenv("GNUTERM", "dumb", 1);
  setenv("LC_ALL", "de_DE.UTF-8", 1);
  const GnuplotJob job = printing("exists('x'), ' ', system('echo [$GNUTERM] $LC_ALL')");
  const auto sut = run_gnuplot({&job, 1});
  unsetenv("GNUTERM");
  unsetenv("LC_ALL");
  EXPECT_EQ(sut[0][0], "0   [] C.UTF-8\n");
}

TEST(GnuplotTest, NothingStaysOpenOrUnreaped) {
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
  };
  const auto before = open_files();
  const std::vector<GnuplotJob> jobs{printing("1"), {"set nonsense\n", 3}, printing("2")};
  EXPECT_THROW(run_gnuplot(jobs), std::runtime_error);
  EXPECT_EQ(open_files(), before);
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);  // ECHILD: no child is left
}

}  // namespace stillhand::report::gnuplot_test
