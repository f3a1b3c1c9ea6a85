// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/source_window.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/support/memory_bytes.hpp"

namespace stillhand::recording::source_window_test {
namespace {

// Counts the reads of a source, and fails from one of them on.
class CountedSource : public MemorySource {
 public:
  using MemorySource::MemorySource;
  Status read_at(std::uint64_t offset, std::span<std::byte> into) override {
    ++reads;
    if (reads > fails_after) return Status::failure(StatusKind::kIo, "no disk");
    return MemorySource::read_at(offset, into);
  }
  int reads = 0;
  int fails_after = 1'000'000;
};

std::vector<std::byte> numbered(std::size_t count) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < count; ++i)
    bytes.push_back(static_cast<std::byte>(i * 2654435761u >> 13));
  return bytes;
}

TEST(SourceWindowTest, AnyRangeInsideTheSourceGivesItsBytes) {
  const auto bytes = numbered(300'000);
  CountedSource source(bytes);
  SourceWindow sut(source);
  std::mt19937_64 random(2);
  for (int round = 0; round < 300; ++round) {
    const std::uint64_t offset = random() % (bytes.size() + 1);
    const std::uint64_t most = bytes.size() - offset;
    const std::uint64_t count = std::min<std::uint64_t>(random() % 100'000, most);
    const auto view = sut.view(offset, count);
    ASSERT_EQ(view.size(), count);
    ASSERT_TRUE(std::ranges::equal(view, std::span(bytes).subspan(offset, count))) << offset;
  }
  EXPECT_TRUE(sut.status().ok());
}

TEST(SourceWindowTest, AdjacentSmallRangesNeedOneRead) {
  const auto bytes = numbered(4000);
  CountedSource source(bytes);
  SourceWindow sut(source);
  for (std::uint64_t offset = 0; offset < bytes.size(); offset += 100) {
    ASSERT_EQ(sut.view(offset, 100).size(), 100u);
  }
  EXPECT_EQ(source.reads, 1);
}

TEST(SourceWindowTest, ARangeOutsideTheSourceIsEmptyAndNoFailure) {
  const auto bytes = numbered(100);
  CountedSource source(bytes);
  SourceWindow sut(source);
  EXPECT_TRUE(sut.view(50, 51).empty());
  EXPECT_TRUE(sut.view(101, 0).empty());
  EXPECT_TRUE(sut.view(UINT64_MAX, 1).empty());
  EXPECT_TRUE(sut.view(1, UINT64_MAX).empty());
  EXPECT_TRUE(sut.view(100, 0).empty());
  EXPECT_TRUE(sut.status().ok());
  EXPECT_EQ(sut.view(99, 1).size(), 1u);
}

TEST(SourceWindowTest, TheFirstFailureStaysAndNothingIsReadAfterIt) {
  const auto bytes = numbered(200'000);
  CountedSource source(bytes);
  source.fails_after = 1;
  SourceWindow sut(source);
  ASSERT_EQ(sut.view(0, 10).size(), 10u);
  EXPECT_TRUE(sut.view(150'000, 10).empty());
  EXPECT_EQ(sut.status().kind, StatusKind::kIo);
  EXPECT_EQ(sut.status().text, "no disk");
  EXPECT_TRUE(sut.view(0, 10).empty());
  EXPECT_EQ(source.reads, 2);
}

}  // namespace
}  // namespace stillhand::recording::source_window_test
