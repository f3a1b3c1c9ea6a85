// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/serial_side.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace stillhand::emulators {

SerialSide::SerialSide(std::filesystem::path link) : link_(std::move(link)) { put_in(); }

SerialSide::~SerialSide() {
  pull_out();
  std::error_code ignored;
  std::filesystem::remove(link_, ignored);
}

void SerialSide::put_in() {
  if (master_ >= 0) return;
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> name{};
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
      ptsname_r(master_, name.data(), name.size()) != 0) {
    throw std::runtime_error("no pseudo-terminal");
  }
  slave_ = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  tcgetattr(slave_, &settings);
  cfmakeraw(&settings);
  tcsetattr(slave_, TCSANOW, &settings);
  // Next to it first: the name always leads somewhere.
  const std::filesystem::path fresh = link_.string() + ".new";
  std::error_code ignored;
  std::filesystem::remove(fresh, ignored);
  std::filesystem::create_symlink(name.data(), fresh);
  std::filesystem::rename(fresh, link_);
}

void SerialSide::pull_out() {
  if (master_ < 0) return;
  close(slave_);
  close(master_);
  master_ = slave_ = -1;
  held_.clear();
}

std::string SerialSide::read() {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(master_, bytes.data(), bytes.size());
  if (count <= 0 || mischief.deaf) return {};
  return {bytes.data(), static_cast<std::size_t>(count)};
}

void SerialSide::send(const std::string& text) {
  if (master_ < 0) return;
  [[maybe_unused]] const ssize_t count = ::write(master_, text.data(), text.size());
}

std::string SerialSide::spoilt(std::string answer) {
  const auto next = [this] { return random_ = random_ * 1664525u + 1013904223u; };
  if (mischief.garbage) {
    for (char& c : answer) c = static_cast<char>(next() >> 24);
  }
  constexpr std::string_view kReply = "rcv 100 ";
  constexpr std::size_t kDigit = kReply.size() + 4;  // of the mode
  for (std::size_t at = answer.find(kReply); mischief.damaged && at != std::string::npos;
       at = answer.find(kReply, at + 1)) {
    answer[at + kDigit] = answer[at + kDigit] == '0' ? '1' : '0';
  }
  // A host that was late asks twice at once: nothing of the second answer is left either.
  if (const std::size_t at = answer.find(kReply); mischief.truncated && at != std::string::npos) {
    answer.resize(at + 40);
  }
  if (mischief.repeated) return last_.empty() ? answer : last_;
  last_ = answer;
  return answer;
}

void SerialSide::write(const std::string& answer, std::int64_t now_ns) {
  if (answer.empty() || mischief.silent) return;
  std::string text = spoilt(answer);
  if (mischief.late_ms > 0.0 || !held_.empty()) {
    held_.push_back({now_ns + static_cast<std::int64_t>(1e6 * mischief.late_ms), std::move(text)});
  } else {
    send(text);
  }
}

void SerialSide::send_due(std::int64_t now_ns) {
  while (!held_.empty() && held_.front().due_ns <= now_ns) {
    send(held_.front().text);
    held_.pop_front();
  }
}

}  // namespace stillhand::emulators
