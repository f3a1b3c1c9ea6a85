// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/in_child.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::in_child_test {

using testing::HasSubstr;

std::string error_of(const std::function<void(Wire&)>& work) {
  return support::refusal(
      [&] { in_child("ride.mat", work, [](Wire& wire) { (void)wire.get_numbers(10); }); });
}

TEST(InChildTest, WhatTheChildPutsArrives) {
  std::string text;
  std::vector<double> numbers;
  double number = 0.0;
  std::uint64_t count = 0;
  in_child(
      "x",
      [](Wire& wire) {
        wire.put(std::string("a\0b", 3));
        wire.put(std::vector<double>(100'000, 1.5));
        wire.put(0.1);
        wire.put(std::uint64_t{7});
      },
      [&](Wire& wire) {
        text = wire.get_text();
        numbers = wire.get_numbers(100'000);
        number = wire.get_number();
        count = wire.get_count(7);
      });
  EXPECT_EQ(text, std::string("a\0b", 3));
  EXPECT_EQ(numbers, std::vector<double>(100'000, 1.5));
  EXPECT_EQ(number, 0.1);
  EXPECT_EQ(count, 7u);
}

TEST(InChildTest, ARefusalArrivesAsItIs) {
  EXPECT_EQ(error_of([](Wire&) { throw Refused{"where", "this", "that"}; }),
            "where: got this, want that");
}

TEST(InChildTest, ACrashIsARefusal) {
  EXPECT_THAT(error_of([](Wire&) { raise(SIGKILL); }),
              HasSubstr("ride.mat: got a file that its library cannot read to the end (Killed)"));
  EXPECT_THAT(error_of([](Wire&) { _exit(0); }), HasSubstr("cannot read to the end"));
  EXPECT_THAT(error_of([](Wire&) { throw std::runtime_error("x"); }),
              HasSubstr("cannot read to the end"));
  EXPECT_THAT(error_of([](Wire& wire) {
                wire.put(std::uint64_t{3});  // of three numbers that do not come
              }),
              HasSubstr("cannot read to the end"));
}

TEST(InChildTest, MoreThanExpectedIsRefused) {
  EXPECT_THAT(error_of([](Wire& wire) { wire.put(std::vector<double>(11)); }),
              HasSubstr("cannot read to the end"));
}

TEST(InChildTest, NothingOfTheParentIsWrittenTwice) {
  testing::internal::CaptureStdout();
  std::printf("a");
  in_child("x", [](Wire& wire) { wire.put(0.0); }, [](Wire& wire) { (void)wire.get_number(); });
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "a");
}

}  // namespace stillhand::measurement::in_child_test
