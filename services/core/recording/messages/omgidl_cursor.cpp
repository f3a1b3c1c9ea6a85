// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/omgidl_cursor.hpp"

#include <algorithm>

#include "services/core/contract/config_error.hpp"

namespace stillhand::recording {
namespace {

constexpr std::size_t kQuotedCharacters = 40;

}  // namespace

std::string_view IdlCursor::peek(std::ptrdiff_t ahead) const {
  const auto last = static_cast<std::ptrdiff_t>(cut_.tokens.size() - 1);
  const auto place = static_cast<std::ptrdiff_t>(at_) + ahead;
  return cut_.tokens[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(place, 0, last))].text;
}

std::string_view IdlCursor::take() {
  const std::string_view text = peek();
  if (!text.empty()) ++at_;
  return text;
}

bool IdlCursor::accept(std::string_view text) {
  if (peek() != text) return false;
  take();
  return true;
}

void IdlCursor::expect(std::string_view text) {
  if (!accept(text)) refuse(std::string(text));
}

void IdlCursor::refuse(const std::string& want) const {
  const IdlToken& token = cut_.tokens[at_];
  throw ConfigError(
      source_ + ", IDL line " + std::to_string(token.line) + ":" + std::to_string(token.column),
      token.text.empty() ? "the end of the text"
                         : "'" + std::string(token.text.substr(0, kQuotedCharacters)) + "'",
      want);
}

std::string IdlCursor::name() {
  const char first = peek().empty() ? '\0' : peek()[0];
  const bool word =
      first == '_' || (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z');
  if (!word) refuse("a name");
  return std::string(take());
}

std::string IdlCursor::scoped_name() {
  std::string text = accept("::") ? "::" : "";
  text += name();
  while (accept("::")) text += "::" + name();
  return text;
}

void IdlCursor::skip_balanced() {
  int depth = 0;
  do {
    const std::string_view text = take();
    if (text.empty()) refuse("a closing bracket");
    if (text == "{" || text == "(") ++depth;
    if (text == "}" || text == ")") --depth;
  } while (depth > 0);
}

void IdlCursor::skip_definition() {
  while (peek() != ";") {
    if (peek() == "{" || peek() == "(") {
      skip_balanced();
    } else if (take().empty()) {
      refuse(";");
    }
  }
  take();
}

std::string_view IdlCursor::comment_here() const {
  const auto comment = cut_.comments.find(cut_.tokens[at_].line);
  return comment == cut_.comments.end() ? std::string_view() : comment->second;
}

}  // namespace stillhand::recording
