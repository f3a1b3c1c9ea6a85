// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/keep_options.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "services/system/command_line/command_line.hpp"

namespace stillhand::recording::keep_options_test {
namespace {

// What a recorder's command line makes of these words.
KeepOptions parsed(std::vector<std::string> words) {
  command_line::Program cli;
  KeepOptions options;
  add_keep_options(cli, options);
  cli.parse(std::move(words));
  return options;
}

TEST(KeepOptionsTest, NothingSaidIsTheDefault) { EXPECT_EQ(parsed({}), KeepOptions{}); }

TEST(KeepOptionsTest, AnotherProcessHearsTheSame) {
  for (const Compression packing : {Compression::kNone, Compression::kLz4, Compression::kZstd}) {
    for (const Durability durability : {Durability::kProcess, Durability::kPower}) {
      const KeepOptions wanted{packing, std::chrono::milliseconds(37), durability, 1.0 / 3.0};
      EXPECT_EQ(parsed(keep_words(wanted)), wanted);
    }
  }
  EXPECT_EQ(parsed(keep_words({})), KeepOptions{});
}

TEST(KeepOptionsTest, WhatCannotBeIsRefused) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"--compression", "gzip"},
                                                {"--flush-ms", "9"},
                                                {"--flush-ms", "801"},
                                                {"--flush-ms", "nan"},
                                                {"--min-free-mb", "nan"},
                                                {"--min-free-mb", "-1"}}) {
    EXPECT_THROW(parsed(words), command_line::UsageError) << words.back();
  }
}

}  // namespace
}  // namespace stillhand::recording::keep_options_test
