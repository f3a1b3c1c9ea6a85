// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cxxabi.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/idl_text.hpp"

namespace stillhand::tests {

/// A message's fields in the order of the IDL: name and value.  Doubles are written with so many
/// digits that any two of them differ in their text.
using Fields = std::vector<std::pair<std::string, std::string>>;

namespace detail {

template <typename Message>
std::string idl_name() {
  const std::unique_ptr<char, void (*)(void*)> name(
      abi::__cxa_demangle(typeid(Message).name(), nullptr, nullptr, nullptr), std::free);
  const std::string text = name.get();
  return text.substr(text.rfind(':') + 1);
}

/// Body of a struct in the IDL texts.
inline std::string idl_struct(const std::string& name) {
  for (const auto text : topics::kIdlTexts) {
    const auto begin = text.find("struct " + name + " {");
    if (begin == std::string_view::npos) continue;
    const auto body = text.find('\n', begin) + 1;
    return std::string(text.substr(body, text.find("};", body) - body));
  }
  throw std::runtime_error("no struct " + name + " in the IDL");
}

inline std::string next_value(eprosima::fastcdr::Cdr& cdr, const std::string& type) {
  const auto read = [&cdr](auto value) {
    cdr >> value;
    return fmt::format("{}", value);
  };
  if (type == "double") return read(0.0);
  if (type == "boolean") return read(false);
  if (type == "long") return read(std::int32_t{});
  if (type == "unsigned long") return read(std::uint32_t{});
  if (type == "long long") return read(std::int64_t{});
  if (type == "unsigned long long") return read(std::uint64_t{});
  if (type.starts_with("string")) return read(std::string{});
  if (type.starts_with("sequence<double")) return read(std::vector<double>{});
  if (type.starts_with("sequence")) throw std::runtime_error("no reader for " + type);
  return read(std::uint32_t{});  // an enumeration
}

}  // namespace detail

/// Every field that the IDL gives to this message; a field added there appears here by itself.
template <typename Message>
Fields fields_of(const Message& message) {
  auto bytes = to_cdr(message);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  fast_cdr::PlainCdr cdr(buffer);
  cdr.read_encapsulation();
  Fields fields;
  std::istringstream lines(detail::idl_struct(detail::idl_name<Message>()));
  for (std::string line; std::getline(lines, line);) {
    const auto end = line.find(';');
    if (end == std::string::npos) continue;
    const auto name = line.rfind(' ', end) + 1;
    auto type = line.find_first_not_of(' ');
    if (line.compare(type, 5, "@key ") == 0) type += 5;
    fields.emplace_back(line.substr(name, end - name),
                        detail::next_value(cdr, line.substr(type, name - 1 - type)));
  }
  return fields;
}

/// The fields in which two messages differ, for a person: "force_n 1.5 instead of 1.25; ".
template <typename Message>
std::string differences(const Message& got, const Message& wanted) {
  const Fields got_fields = fields_of(got);
  const Fields wanted_fields = fields_of(wanted);
  std::string text;
  for (std::size_t i = 0; i < wanted_fields.size(); ++i) {
    if (got_fields[i] == wanted_fields[i]) continue;
    text += fmt::format("{} {} instead of {}; ", wanted_fields[i].first, got_fields[i].second,
                        wanted_fields[i].second);
  }
  return text;
}

}  // namespace stillhand::tests
