// SPDX-License-Identifier: Apache-2.0
// Standard input is a pseudo-terminal of the test, which types on its other end.
#include "apps/replay/keyboard.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace stillhand::replay::keyboard_test {
namespace {

constexpr long kPatience_ns = 900'000'000;

class KeyboardTest : public testing::Test {
 protected:
  KeyboardTest()
      : stdin_(fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)),
        typist_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    EXPECT_EQ(grantpt(typist_), 0);
    EXPECT_EQ(unlockpt(typist_), 0);
    const int terminal = open(ptsname(typist_), O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_GE(dup2(terminal, STDIN_FILENO), 0);
    close(terminal);
  }
  ~KeyboardTest() override {
    if (stdin_ >= 0) {
      dup2(stdin_, STDIN_FILENO);
      close(stdin_);
    } else {
      close(STDIN_FILENO);
    }
    close(typist_);
  }
  void type(std::string_view bytes) const {
    ASSERT_EQ(write(typist_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  static tcflag_t local_flags() {
    termios settings{};
    EXPECT_EQ(tcgetattr(STDIN_FILENO, &settings), 0);
    return settings.c_lflag;
  }

  int stdin_, typist_;
};

TEST_F(KeyboardTest, EachKeyOfTheHelpHasItsMeaning) {
  Keyboard sut(true);
  ASSERT_TRUE(sut.active());
  const std::pair<const char*, Key> keys[]{
      {" ", Key::kPause},        {"s", Key::kStep},      {"q", Key::kQuit},
      {"+", Key::kFaster},       {"-", Key::kSlower},    {"a", Key::kLoopFrom},
      {"b", Key::kLoopTo},       {"c", Key::kLoopOff},   {"\033[D", Key::kBack},
      {"\033[C", Key::kForward}, {"\033OD", Key::kBack}, {"\033OC", Key::kForward}};
  for (const auto& [bytes, key] : keys) {
    type(bytes);
    EXPECT_EQ(sut.wait(kPatience_ns), key) << bytes;
  }
}

TEST_F(KeyboardTest, KeysThatWereTypedTogetherComeOneByOne) {
  Keyboard sut(true);
  type("s\033[C ");
  EXPECT_EQ(sut.wait(kPatience_ns), Key::kStep);
  EXPECT_EQ(sut.wait(kPatience_ns), Key::kForward);
  EXPECT_EQ(sut.wait(kPatience_ns), Key::kPause);
  EXPECT_EQ(sut.wait(0), std::nullopt);
}

TEST_F(KeyboardTest, AnyOtherKeyDoesNothingAndTheNextOneCounts) {
  Keyboard sut(true);
  for (const char* other : {"x", "S", "\n", "\033[A", "\xc3"}) {
    type(other);
    EXPECT_EQ(sut.wait(kPatience_ns), std::nullopt) << other;
    type("q");
    EXPECT_EQ(sut.wait(kPatience_ns), Key::kQuit) << other;
  }
}

TEST_F(KeyboardTest, TheTerminalGetsItsSettingsBack) {
  const tcflag_t before = local_flags();
  ASSERT_NE(before & static_cast<tcflag_t>(ICANON | ECHO), 0u);
  {
    const Keyboard sut(true);
    EXPECT_EQ(local_flags() & static_cast<tcflag_t>(ICANON | ECHO), 0u);
    EXPECT_NE(local_flags() & static_cast<tcflag_t>(ISIG), 0u);  // Ctrl-C stays a signal
  }
  EXPECT_EQ(local_flags(), before);
}

TEST_F(KeyboardTest, WhereNoKeysAreWantedTheTerminalStaysAsItIs) {
  const tcflag_t before = local_flags();
  Keyboard sut(false);
  EXPECT_FALSE(sut.active());
  EXPECT_EQ(local_flags(), before);
  type("q\n");
  EXPECT_EQ(sut.wait(0), std::nullopt);
}

TEST_F(KeyboardTest, AFileAsStandardInputGivesNoKeys) {
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  close(nothing);
  Keyboard sut(true);
  EXPECT_FALSE(sut.active());
  EXPECT_EQ(sut.wait(0), std::nullopt);
}

}  // namespace
}  // namespace stillhand::replay::keyboard_test
