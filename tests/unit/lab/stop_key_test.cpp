// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/stop_key.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::lab::stop_key_test {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<input_event> events) {
  std::vector<std::byte> bytes;
  for (const input_event& event : events) {
    const auto* first = reinterpret_cast<const std::byte*>(&event);
    bytes.insert(bytes.end(), first, first + sizeof(event));
  }
  return bytes;
}

input_event event_of(unsigned short type, unsigned short code, int value) {
  input_event event{};
  event.type = type;
  event.code = code;
  event.value = value;
  return event;
}

const input_event kPress = event_of(EV_KEY, KEY_ENTER, 1);
const input_event kRelease = event_of(EV_KEY, KEY_ENTER, 0);
const input_event kRepeat = event_of(EV_KEY, KEY_ENTER, 2);
const input_event kEndOfReport = event_of(EV_SYN, SYN_REPORT, 0);
const input_event kScanCode = event_of(EV_MSC, MSC_SCAN, 1);

TEST(KeyPressesTest, APressCountsAndNothingElseDoes) {
  KeyPresses sut;
  EXPECT_FALSE(sut.take(bytes_of({kScanCode, kRelease, kRepeat, kEndOfReport})));
  EXPECT_TRUE(sut.take(bytes_of({kScanCode, kPress, kEndOfReport})));
  EXPECT_FALSE(sut.take(bytes_of({kRelease, kEndOfReport})));
  EXPECT_TRUE(
      sut.take(bytes_of({event_of(EV_KEY, BTN_LEFT, 1)})));  // a foot switch may be a button
}

TEST(KeyPressesTest, AnEventInPiecesIsOneEvent) {
  KeyPresses sut;
  int pressed = 0;
  for (const std::byte byte : bytes_of({kScanCode, kPress, kEndOfReport, kRelease, kPress})) {
    pressed += sut.take({&byte, 1}) ? 1 : 0;
  }
  EXPECT_EQ(pressed, 2);
}

// A pipe stands in for the device.
class StopKeyTest : public testing::Test {
 protected:
  StopKeyTest() {
    mkfifo(pipe_.c_str(), S_IRUSR | S_IWUSR);
    writer_ = open(pipe_.c_str(), O_RDWR | O_CLOEXEC);  // it does not wait for a reader
  }
  ~StopKeyTest() override {
    if (writer_ >= 0) close(writer_);
  }
  void send(const input_event& event) const {
    ASSERT_EQ(write(writer_, &event, sizeof(event)), static_cast<ssize_t>(sizeof(event)));
  }

  const support::Folder folder_;
  const std::filesystem::path pipe_ = folder_ / "stop_key";
  int writer_ = -1;
  std::atomic<int> asked_{0};
};

TEST_F(StopKeyTest, APressAsksSeveralTimes) {
  const StopKey sut(pipe_, [this] { ++asked_; });
  send(kRelease);
  send(kPress);
  EXPECT_TRUE(support::eventually([&] { return asked_ > 2; }));
}

TEST_F(StopKeyTest, AReleaseAloneAsksNothing) {
  {
    const StopKey sut(pipe_, [this] { ++asked_; });
    send(kRelease);
    int unread = 1;
    EXPECT_TRUE(support::eventually([&] {
      const pollfd look{writer_, POLLIN, 0};
      pollfd now = look;
      unread = poll(&now, 1, 0);
      return unread == 0;  // the key's thread took it
    }));
  }
  EXPECT_EQ(asked_, 0);
}

TEST_F(StopKeyTest, ADeviceThatIsLostCountsAsPressed) {
  const StopKey sut(pipe_, [this] { ++asked_; });
  close(writer_);
  writer_ = -1;
  EXPECT_TRUE(support::eventually([&] { return asked_ > 0; }));
}

TEST(StopKeyRefusalTest, ADeviceThatIsNotThereIsRefused) {
  EXPECT_THAT(support::refusal([&] { const StopKey sut("/dev/input/none", [] {}); }),
              testing::HasSubstr("/dev/input/none"));
}

// A plain file ends at once, and an end is a press.
TEST(StopKeyRefusalTest, WhatIsNoInputDeviceIsRefusedAndStopsNothing) {
  for (const char* path : {__FILE__, "/dev/null", "/tmp"}) {
    EXPECT_THAT(support::refusal([&] { const StopKey sut(path, [] { ADD_FAILURE(); }); }),
                testing::AllOf(testing::HasSubstr(path), testing::HasSubstr("no input device")));
  }
}

}  // namespace
}  // namespace stillhand::lab::stop_key_test
