// SPDX-License-Identifier: Apache-2.0
// The device is a named pipe: this tests the events, not a driver.
#include "services/processes/display/gamepad.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>

#include "services/core/contract/config_error.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::display::gamepad_test {

std::vector<std::byte> event(unsigned type, unsigned code, std::int32_t value) {
  input_event out{};
  out.type = static_cast<std::uint16_t>(type);
  out.code = static_cast<std::uint16_t>(code);
  out.value = value;
  std::vector<std::byte> bytes(sizeof out);
  std::memcpy(bytes.data(), &out, sizeof out);
  return bytes;
}

class GamepadTest : public testing::Test {
 protected:
  GamepadTest() {
    mkfifo(pipe_.c_str(), 0600);
    sut_.emplace(pipe_);
    writer_ = open(pipe_.c_str(), O_WRONLY);
  }
  ~GamepadTest() override {
    if (writer_ >= 0) close(writer_);
  }
  void put(const std::vector<std::byte>& bytes) const {
    ASSERT_EQ(write(writer_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }

  const support::Folder folder_;
  const std::string pipe_ = folder_ / "gamepad";
  std::optional<Gamepad> sut_;
  int writer_ = -1;
};

TEST(ShareOfAxisTest, TheMiddleIsZeroAndTheEndsAreOne) {
  EXPECT_DOUBLE_EQ(share_of_axis(0, 0, 255), -1.0);
  EXPECT_DOUBLE_EQ(share_of_axis(255, 0, 255), 1.0);
  EXPECT_NEAR(share_of_axis(128, 0, 255), 0.0, 1.0 / 255.0);
  EXPECT_DOUBLE_EQ(share_of_axis(900, 0, 255), 1.0);  // beyond what the device said
  EXPECT_DOUBLE_EQ(share_of_axis(-900, -100, 100), -1.0);
}

TEST_F(GamepadTest, TheNewestPositionOfTheLeftRightAxisCounts) {
  EXPECT_EQ(sut_->position(), std::nullopt);
  put(event(EV_ABS, ABS_X, -32768));
  put(event(EV_ABS, ABS_X, 32767));
  put(event(EV_ABS, ABS_Y, -32768));
  put(event(EV_KEY, BTN_SOUTH, 1));
  EXPECT_EQ(sut_->position(), 1.0);
  EXPECT_EQ(sut_->position(), 1.0);  // nothing new: it stays
}

TEST_F(GamepadTest, AnEventThatComesInPiecesCountsWhenItIsWhole) {
  const auto bytes = event(EV_ABS, ABS_X, -32768);
  put({bytes.begin(), bytes.begin() + 5});
  EXPECT_EQ(sut_->position(), std::nullopt);
  put({bytes.begin() + 5, bytes.end()});
  EXPECT_EQ(sut_->position(), -1.0);
}

TEST_F(GamepadTest, ADeviceThatIsGoneHasNoPosition) {
  put(event(EV_ABS, ABS_X, 1000));
  ASSERT_TRUE(sut_->position());
  close(std::exchange(writer_, -1));
  EXPECT_EQ(sut_->position(), std::nullopt);
}

TEST_F(GamepadTest, PressedButtonsAnswerOnceAndInTheirOrder) {
  using enum PadAct;
  const std::vector<std::vector<std::byte>> events{
      event(EV_ABS, ABS_HAT0X, -1), event(EV_ABS, ABS_HAT0X, 0),       // D-pad
      event(EV_KEY, BTN_TR, 1),     event(EV_KEY, BTN_TR, 2),          // held
      event(EV_KEY, BTN_TR, 0),     event(EV_KEY, BTN_DPAD_RIGHT, 1),  // released
      event(EV_KEY, BTN_THUMB, 1),  event(EV_KEY, BTN_EAST, 1),        // B does nothing
      event(EV_ABS, ABS_X, 32767),  event(EV_KEY, BTN_SOUTH, 1),
      event(EV_KEY, BTN_TRIGGER, 1)};
  for (const auto& each : events) put(each);
  EXPECT_EQ(sut_->position(), 1.0);
  EXPECT_EQ(sut_->acts(), (std::vector{kLeft, kRight, kRight, kLeft, kConfirm, kConfirm}));
  EXPECT_EQ(sut_->acts(), std::vector<PadAct>());
}

TEST(GamepadRefusalTest, ADeviceThatIsNotThereIsRefused) {
  EXPECT_THROW(Gamepad("/nowhere/event5"), ConfigError);
}

}  // namespace stillhand::display::gamepad_test
