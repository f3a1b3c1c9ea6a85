// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/inventory_values.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cstdint>

#include "services/core/contract/config_error.hpp"

namespace stillhand::deploy {

using settings::Entry;
using settings::SectionReader;

void refuse(const Entry& entry, const std::string& path, const std::string& want) {
  throw ConfigError(entry.place + ": " + path, settings::got_of(entry), want);
}

void refuse_second(const Entry& entry, const std::string& path, const Entry& first,
                   const std::string& want) {
  throw ConfigError(entry.place + ": " + path, settings::got_of(entry) + " a second time",
                    want + "; the first is at " + first.place);
}

std::string item_path(const std::string& list, std::size_t index) {
  return list + "[" + std::to_string(index) + "]";
}

std::string text_of(const Entry& entry, const std::string& path, const std::string& want) {
  if (entry.kind != Entry::Kind::kScalar || entry.text.empty()) refuse(entry, path, want);
  return entry.text;
}

const std::vector<Entry>& items_of(const Entry& entry, const std::string& path,
                                   const std::string& want) {
  if (entry.kind != Entry::Kind::kSequence) refuse(entry, path, want);
  return entry.children;
}

void allow_only(SectionReader& reader, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) reader.find(key);
  reader.refuse_unknown();
}

const Entry& required(SectionReader& reader, const Entry& section, const std::string& path,
                      std::string_view key, const std::string& want) {
  if (const Entry* entry = reader.find(key)) return *entry;
  throw ConfigError(section.place + ": " + path, "no \"" + std::string(key) + "\"", want);
}

std::string name_in(const Entry& entry, const std::string& path) {
  constexpr std::size_t kLongest = 63;
  const std::string want = "1 to 63 letters, digits and '-', a letter or digit first";
  std::string name = text_of(entry, path, want);
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  const bool good = name.size() <= kLongest && plain(name.front()) &&
                    std::ranges::all_of(name, [&](char c) { return plain(c) || c == '-'; });
  if (!good) refuse(entry, path, want);
  return name;
}

std::string address_in(const Entry& entry, const std::string& path) {
  const std::string want =
      "the IPv4 address of one interface of that host, such as 192.168.7.1 (Fast DDS accepts no "
      "names)";
  std::string address = text_of(entry, path, want);
  in_addr binary{};
  if (inet_pton(AF_INET, address.c_str(), &binary) != 1) refuse(entry, path, want);
  const std::uint32_t number = ntohl(binary.s_addr);
  constexpr std::uint32_t kFirstMulticast = 0xe0000000;  // 224.0.0.0, and reserved ones above
  constexpr std::uint32_t kFirstOfANetwork = 0x01000000;
  if (number < kFirstOfANetwork || number >= kFirstMulticast) refuse(entry, path, want);
  return address;
}

}  // namespace stillhand::deploy
