// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace stillhand {

/// Text from a file or command line for one line of a message: '?' replaces control characters, and
/// a text of more than 1000 bytes is cut and ends in "...".
inline std::string in_one_line(std::string text) {
  constexpr std::size_t kMost = 1000;
  constexpr char kDelete = 0x7f;
  if (text.size() > kMost) {
    std::size_t end = kMost;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;  // UTF-8
    text.resize(end);
    text += "...";
  }
  for (char& c : text) {
    if ((c >= 0 && c < ' ') || c == kDelete) c = '?';
  }
  return text;
}

/// A mistake in a setting or file that the operator can correct.  Thrown only before a run; main()
/// prints it as one line and exits with status 2.
class ConfigError : public std::runtime_error {
 public:
  /// Message: "<key>: got <got>, want <want>", for example
  /// "motion.components[0].harmonic: got 4000, want 0 < k < 4000 (Nyquist)".
  ConfigError(const std::string& key, const std::string& got, const std::string& want)
      : std::runtime_error(in_one_line(key) + ": got " + in_one_line(got) + ", want " + want) {}
};

}  // namespace stillhand
