// SPDX-License-Identifier: Apache-2.0
// Real files in a folder of the test's own.
#include "apps/libraries/experiment/file/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <stdexcept>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::experiment::journal_test {
namespace {

// A file size limit plays the full disk: the system then cuts a write short, as a disk does.
TEST(JournalTest, AShortWriteLeavesWholeLinesAndIsReportedWithItsReason) {
  const support::Folder folder;
  const auto file = folder / "journal";
  {
    Journal sut(file);
    sut.append({.kind = EntryKind::kSessionBegan, .session = 1});
    const auto whole = std::filesystem::file_size(file);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{whole + 10, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    const std::string why = support::refusal<std::runtime_error>(
        [&] { sut.append({.kind = EntryKind::kTrialBegan, .session = 1, .step = 0, .trial = 1}); });
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_THAT(why, testing::HasSubstr("cannot write: File too large"));
    EXPECT_EQ(std::filesystem::file_size(file), whole);
    sut.append({.kind = EntryKind::kNote, .session = 1, .text = "disk was full"});
  }
  const Journal again(file);
  ASSERT_EQ(again.entries().size(), 2U);
  EXPECT_EQ(again.entries().back().text, "disk was full");
}

}  // namespace
}  // namespace stillhand::experiment::journal_test
