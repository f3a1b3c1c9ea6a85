// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/qos_texts.hpp"

#include <array>
#include <charconv>
#include <string_view>

namespace stillhand::recording {

using runtime::kForever_ns;
using runtime::Liveliness;

namespace {

constexpr std::array<std::string_view, 4> kDurability{"volatile", "transient_local", "transient",
                                                      "persistent"};
constexpr std::array<std::string_view, 3> kLiveliness{"automatic", "manual_by_participant",
                                                      "manual_by_topic"};

std::string text_of(std::int64_t ns) { return ns == kForever_ns ? "infinite" : std::to_string(ns); }

/// Entry of a table by its word; `otherwise` for any other text.
template <typename Enum, std::size_t N>
Enum enum_of(const std::array<std::string_view, N>& words, std::string_view text, Enum otherwise) {
  for (std::size_t i = 0; i < N; ++i) {
    if (words[i] == text) return static_cast<Enum>(i);
  }
  return otherwise;
}

template <typename Number>
Number number_of(std::string_view text, Number otherwise) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value > 0 ? value : otherwise;
}

}  // namespace

TextMap qos_texts(const runtime::WriterQos& qos) {
  TextMap texts;
  texts["qos.reliability"] = qos.reliable ? "reliable" : "best_effort";
  texts["qos.durability"] = kDurability[static_cast<std::size_t>(qos.durability)];
  texts["qos.liveliness"] = kLiveliness[static_cast<std::size_t>(qos.liveliness)];
  texts["qos.liveliness_lease_ns"] = text_of(qos.lease_ns);
  texts["qos.ownership"] = qos.exclusive ? "exclusive" : "shared";
  texts["qos.deadline_ns"] = text_of(qos.deadline_ns);
  texts["qos.lifespan_ns"] = text_of(qos.lifespan_ns);
  texts["qos.history"] = qos.depth > 0 ? "keep_last" : qos.depth < 0 ? "keep_all" : "unknown";
  if (qos.depth > 0) texts["qos.depth"] = std::to_string(qos.depth);
  if (qos.xcdr2) texts["qos.representation"] = "xcdr2";
  if (qos.keyed) texts["keyed"] = "true";
  return texts;
}

std::optional<runtime::WriterQos> qos_of(const TextMap& texts) {
  if (texts.count("qos.reliability") == 0) return std::nullopt;
  const auto text = [&texts](const char* key) -> std::string_view {
    const auto found = texts.find(key);
    return found == texts.end() ? std::string_view{} : std::string_view(found->second);
  };
  runtime::WriterQos qos;
  qos.reliable = text("qos.reliability") == "reliable";
  qos.durability = enum_of(kDurability, text("qos.durability"), runtime::Durability::kVolatile);
  qos.liveliness = enum_of(kLiveliness, text("qos.liveliness"), Liveliness::kAutomatic);
  qos.lease_ns = number_of(text("qos.liveliness_lease_ns"), kForever_ns);
  qos.exclusive = text("qos.ownership") == "exclusive";
  qos.deadline_ns = number_of(text("qos.deadline_ns"), kForever_ns);
  qos.lifespan_ns = number_of(text("qos.lifespan_ns"), kForever_ns);
  qos.depth = text("qos.history") == "keep_all" ? -1 : number_of(text("qos.depth"), 0);
  qos.xcdr2 = text("qos.representation") == "xcdr2";
  qos.keyed = text("keyed") == "true";
  return qos;
}

}  // namespace stillhand::recording
