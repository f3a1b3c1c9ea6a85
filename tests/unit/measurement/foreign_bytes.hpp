// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace stillhand::measurement::made {

/// Their bytes, one value behind the other.
template <typename... Values>
std::string packed(const Values&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return bytes;
}

/// XDF 1.0: a length of four bytes, the tag, the content.
inline std::string xdf_chunk(std::uint16_t tag, const std::string& content) {
  const auto length = static_cast<std::uint32_t>(content.size() + sizeof(tag));
  return packed(std::uint8_t{4}, length, tag) + content;
}

/// TDMS: numbers in either byte order; a text has its length in front.
class Tdms {
 public:
  explicit Tdms(bool big_endian) : big_(big_endian) {}

  template <typename Value>
  Tdms& add(Value value) {
    std::string bytes = packed(value);
    if (big_) std::ranges::reverse(bytes);
    bytes_ += bytes;
    return *this;
  }
  Tdms& text(const std::string& words) {
    add(static_cast<std::uint32_t>(words.size()));
    bytes_ += words;
    return *this;
  }
  /// A property of each kind.
  Tdms& number(const std::string& name, double value) {
    return text(name).add(std::uint32_t{10}).add(value);
  }
  Tdms& whole(const std::string& name, std::uint32_t value) {
    return text(name).add(std::uint32_t{7}).add(value);
  }
  Tdms& words(const std::string& name, const std::string& value) {
    return text(name).add(std::uint32_t{0x20}).text(value);
  }
  /// An object with raw data; its properties follow.
  Tdms& object(const std::string& path, std::uint32_t type, std::uint64_t count,
               std::uint32_t properties) {
    text(path).add(std::uint32_t{20}).add(type).add(std::uint32_t{1});
    return add(count).add(properties);
  }
  /// The segment of these metadata and raw data.
  [[nodiscard]] std::string segment(std::uint32_t contents, const std::string& raw) const {
    Tdms lead(big_);
    lead.add(std::uint32_t{4713}).add(std::uint64_t{bytes_.size() + raw.size()});
    lead.add(std::uint64_t{bytes_.size()});
    return "TDSm" + packed(contents | (big_ ? 64u : 0u)) + lead.bytes() + bytes_ + raw;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  bool big_;
  std::string bytes_;
};

}  // namespace stillhand::measurement::made
