// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/omgidl_tokens.hpp"

#include <algorithm>

namespace stillhand::recording {
namespace {

// Longer than any unit; shorter than prose in brackets.
constexpr std::size_t kLongestUnit = 24;

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// Walks over the text and tracks its position.
class Cutter {
 public:
  explicit Cutter(std::string_view text) : text_(text) {}

  IdlTokens cut() {
    while (at_ < text_.size()) step();
    found_.tokens.push_back(token(0));
    return std::move(found_);
  }

 private:
  void step() {
    const std::string_view rest = text_.substr(at_);
    if (is_blank(rest[0])) {
      advance(1);
    } else if (rest.starts_with("//")) {
      comment(std::min(rest.find('\n'), rest.size()), 2);
    } else if (rest.starts_with("/*")) {
      const std::size_t end = rest.find("*/", 2);
      comment(end == std::string_view::npos ? rest.size() : end + 2, 2);
    } else if (rest[0] == '#') {
      advance(std::min(rest.find('\n'), rest.size()));
    } else {
      found_.tokens.push_back(token(length_of(rest)));
      advance(found_.tokens.back().text.size());
    }
  }

  static std::size_t length_of(std::string_view rest) {
    if (rest[0] == '"' || rest[0] == '\'') {
      std::size_t end = 1;
      while (end < rest.size() && rest[end] != rest[0]) end += rest[end] == '\\' ? 2 : 1;
      return std::min(end + 1, rest.size());
    }
    if (rest.starts_with("::")) return 2;
    std::size_t length = 0;
    while (length < rest.size() && is_word(rest[length])) ++length;
    return std::max<std::size_t>(length, 1);
  }

  void comment(std::size_t length, std::size_t lead) {
    found_.comments.try_emplace(line_, text_.substr(at_ + lead, length - lead));
    advance(length);
  }

  [[nodiscard]] IdlToken token(std::size_t length) const {
    return {text_.substr(at_, length), line_, at_ - line_start_ + 1};
  }

  void advance(std::size_t count) {
    for (; count > 0; --count, ++at_) {
      if (text_[at_] != '\n') continue;
      ++line_;
      line_start_ = at_ + 1;
    }
  }

  std::string_view text_;
  IdlTokens found_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  std::size_t line_start_ = 0;
};

}  // namespace

IdlTokens cut_idl(std::string_view text) { return Cutter(text).cut(); }

std::string unit_in(std::string_view comment) {
  const std::size_t open = comment.find('[');
  const std::size_t close = comment.find(']', open);
  if (open == std::string_view::npos || close == std::string_view::npos) return {};
  const std::string_view unit = comment.substr(open + 1, close - open - 1);
  const bool number = std::ranges::all_of(unit, [](char c) { return c >= '0' && c <= '9'; });
  const bool printable = std::ranges::all_of(unit, [](char c) { return c >= ' ' || c < 0; });
  return number || !printable || unit.size() > kLongestUnit ? std::string() : std::string(unit);
}

}  // namespace stillhand::recording
