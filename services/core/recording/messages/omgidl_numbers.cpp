// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/omgidl_numbers.hpp"

#include <charconv>
#include <cstddef>
#include <string_view>
#include <system_error>

namespace stillhand::recording {
namespace {

constexpr std::int64_t kMaxLength = UINT32_MAX;
constexpr int kMaxBrackets = 64;

class Number {
 public:
  Number(IdlCursor& in, const IdlNames& names) : in_(in), names_(names) {}

  std::int64_t sum(int depth) {
    std::int64_t value = product(depth);
    for (;;) {
      if (in_.accept("+")) {
        value = bounded(value + product(depth));
      } else if (in_.accept("-")) {
        value = bounded(value - product(depth));
      } else {
        return value;
      }
    }
  }

 private:
  std::int64_t product(int depth) {
    std::int64_t value = factor(depth);
    while (in_.accept("*")) {
      std::int64_t result = 0;
      if (__builtin_mul_overflow(value, factor(depth), &result)) result = INT64_MAX;
      value = bounded(result);
    }
    return value;
  }
  std::int64_t factor(int depth) {
    if (depth > kMaxBrackets) in_.refuse("fewer nested brackets");
    if (in_.accept("-")) return -factor(depth + 1);
    if (in_.accept("(")) {
      const std::int64_t value = sum(depth + 1);
      in_.expect(")");
      return value;
    }
    const std::string_view text = in_.peek();
    if (text.empty() || text[0] < '0' || text[0] > '9') {
      const std::size_t start = in_.place();
      const std::int64_t* value = names_.constant(in_.scoped_name());
      if (value == nullptr) {
        in_.go_to(start);
        in_.refuse("a whole number or a known constant");
      }
      return *value;
    }
    const bool hex = text.size() > 2 && (text[1] | 0x20) == 'x';
    const char* begin = text.data() + (hex ? 2 : 0);
    const char* end = text.data() + text.size();
    std::int64_t value = 0;
    const int base = hex ? 16 : text[0] == '0' && text.size() > 1 ? 8 : 10;
    const auto read = std::from_chars(begin, end, value, base);
    if (read.ec != std::errc() || read.ptr != end) in_.refuse("a whole number");
    in_.take();
    return bounded(value);
  }
  // Keeps sums of two of them inside 64 bits.
  std::int64_t bounded(std::int64_t value) const {
    if (value > kMaxLength || value < -kMaxLength) in_.refuse("a number of at most 32 bits");
    return value;
  }

  IdlCursor& in_;
  const IdlNames& names_;
};

}  // namespace

std::int64_t whole_number(IdlCursor& in, const IdlNames& names) { return Number(in, names).sum(0); }

}  // namespace stillhand::recording
