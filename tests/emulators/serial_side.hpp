// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>

namespace stillhand::emulators {

/// What happens to the drive's answers on their way.
struct Mischief {
  bool silent = false;     ///< no answer; the port stays open
  bool deaf = false;       ///< the drive hears nothing; the port stays open
  bool garbage = false;    ///< random bytes in place of each answer
  bool damaged = false;    ///< one digit of each answer is another
  bool truncated = false;  ///< the second half of each answer is missing
  bool repeated = false;   ///< the same answer again and again
  double late_ms = 0.0;
};

/// The drive's end of a serial cable: a pseudo-terminal under a name that stays.
class SerialSide {
 public:
  explicit SerialSide(std::filesystem::path link);
  ~SerialSide();
  SerialSide(const SerialSide&) = delete;
  SerialSide& operator=(const SerialSide&) = delete;

  /// -1: the cable is out.
  [[nodiscard]] int descriptor() const { return master_; }
  std::string read();
  void write(const std::string& answer, std::int64_t now_ns);
  /// Sends what was held up and is due.
  void send_due(std::int64_t now_ns);
  void pull_out();
  void put_in();
  Mischief mischief;

 private:
  struct Held {
    std::int64_t due_ns;
    std::string text;
  };
  void send(const std::string& text);
  std::string spoilt(std::string answer);

  std::filesystem::path link_;
  int master_ = -1;
  int slave_ = -1;  ///< held open: a terminal that nobody has open reads as an error
  std::deque<Held> held_;
  std::string last_;
  std::uint32_t random_ = 12345;
};

}  // namespace stillhand::emulators
