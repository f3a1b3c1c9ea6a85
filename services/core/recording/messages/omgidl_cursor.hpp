// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "services/core/recording/messages/omgidl_tokens.hpp"

namespace stillhand::recording {

/// A position in an IDL text that moves from token to token.  The text and `source` must outlive
/// it.
class IdlCursor {
 public:
  /// @param source  name for messages
  IdlCursor(std::string_view text, const std::string& source)
      : cut_(cut_idl(text)), source_(source) {}

  /// Token at that distance, ahead or behind; empty at the end of the text.
  [[nodiscard]] std::string_view peek(std::ptrdiff_t ahead = 0) const;
  std::string_view take();
  bool accept(std::string_view text);
  void expect(std::string_view text);
  /// @throws stillhand::ConfigError with line and column of the next token.
  [[noreturn]] void refuse(const std::string& want) const;
  std::string name();
  /// "a::b", or "::a::b" for a name of the outermost scope.
  std::string scoped_name();
  /// Skips from an opening bracket to after its closing bracket.
  void skip_balanced();
  /// Skips to after the semicolon of the definition.
  void skip_definition();

  [[nodiscard]] std::size_t place() const noexcept { return at_; }
  void go_to(std::size_t place) noexcept { at_ = place; }
  /// Comment on the line of the next token; empty: none.
  [[nodiscard]] std::string_view comment_here() const;

 private:
  IdlTokens cut_;
  const std::string& source_;
  std::size_t at_ = 0;
};

}  // namespace stillhand::recording
