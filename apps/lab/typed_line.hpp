// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::lab {

/// The next line that a person types at the terminal; nothing waits for it.
class TypedLine {
 public:
  /// Standard input is a terminal.
  static bool possible();
  /// What was typed before does not count.
  TypedLine();

  /// Whether it is complete.
  bool is_there();
  /// Without its end.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

}  // namespace stillhand::lab
