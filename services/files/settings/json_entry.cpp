// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/json_entry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "services/core/contract/config_error.hpp"

namespace stillhand::settings {

JsonEntry JsonEntry::at(const std::string& key) const {
  if (!json_.is_object()) refuse("an object");
  const auto found = json_.find(key);
  if (found == json_.end()) throw ConfigError(path_ + "." + key, "no such entry", "an entry");
  return {*found, path_ + "." + key};
}

void JsonEntry::allow_only(std::initializer_list<std::string_view> keys) const {
  if (!json_.is_object()) refuse("an object");
  for (const auto& [key, value] : json_.items()) {
    if (std::ranges::find(keys, std::string_view(key)) != keys.end()) continue;
    std::string known;
    for (const std::string_view each : keys)
      known += (known.empty() ? "" : ", ") + std::string(each);
    throw ConfigError(path_ + "." + key, "an unknown entry", "one of " + known);
  }
}

double JsonEntry::number() const {
  if (!json_.is_number()) refuse("a number");
  const auto value = json_.get<double>();
  if (!std::isfinite(value)) refuse("a finite number");
  return value;
}

std::size_t JsonEntry::count() const {
  if (!json_.is_number_unsigned()) refuse("a whole number from 0");
  return json_.get<std::size_t>();
}

std::int64_t JsonEntry::whole() const {
  constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const bool fits = !json_.is_number_unsigned() || json_.get<std::uint64_t>() <= kLargest;
  if (!json_.is_number_integer() || !fits) refuse("a whole number");
  return json_.get<std::int64_t>();
}

bool JsonEntry::boolean() const {
  if (!json_.is_boolean()) refuse("true or false");
  return json_.get<bool>();
}

std::string JsonEntry::text() const {
  if (!json_.is_string()) refuse("a text");
  return json_.get<std::string>();
}

std::vector<JsonEntry> JsonEntry::entries(std::size_t least, std::size_t most) const {
  if (!json_.is_array() || json_.size() < least || json_.size() > most) {
    refuse("an array of " + std::to_string(least) + " to " + std::to_string(most) + " entries");
  }
  std::vector<JsonEntry> all;
  for (std::size_t i = 0; i < json_.size(); ++i) {
    all.emplace_back(json_[i], path_ + "[" + std::to_string(i) + "]");
  }
  return all;
}

std::vector<double> JsonEntry::numbers(std::size_t least, std::size_t most) const {
  if (!json_.is_array() || json_.size() < least || json_.size() > most) {
    refuse("an array of " + std::to_string(least) + " to " + std::to_string(most) + " numbers");
  }
  std::vector<double> all;
  for (const JsonEntry& entry : entries(least, most)) all.push_back(entry.number());
  return all;
}

void JsonEntry::refuse(const std::string& want) const {
  constexpr std::size_t kMostShown = 60;
  std::string got = json_.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (got.size() > kMostShown) got = got.substr(0, kMostShown) + "...";
  throw ConfigError(path_, got, want);
}

JsonEntry::Json parsed_json(std::string_view json, const std::string& origin,
                            const std::string& want) {
  using Json = JsonEntry::Json;
  constexpr int kDeepest = 64;              // the library writes and frees entries by recursion
  std::vector<std::set<std::string>> open;  // keys of each open object
  const auto look = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kDeepest) {
      throw ConfigError(origin, "entries nested more than " + std::to_string(kDeepest) + " deep",
                        want);
    }
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key &&
        !open.back().insert(parsed.get<std::string>()).second) {
      throw ConfigError(origin, "the entry \"" + parsed.get<std::string>() + "\" twice",
                        "one such entry");
    }
    return true;
  };
  try {
    return Json::parse(json, look);
  } catch (const Json::exception& error) {
    // The text of the library states line and column, or the number that a double cannot hold. The
    // name of the library precedes it in brackets.
    const std::string text = error.what();
    const std::size_t bracket = text.find("] ");
    throw ConfigError(origin, bracket == std::string::npos ? text : text.substr(bracket + 2), want);
  }
}

}  // namespace stillhand::settings
