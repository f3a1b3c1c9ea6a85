// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/section.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/files/settings/nearest.hpp"

namespace stillhand::settings {
namespace {

// "file:line:column" of a place in a YAML text, counted from 1.
std::string place_of(const YAML::Mark& mark, const std::string& source_name) {
  if (mark.is_null()) return source_name;
  return source_name + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
}

// Where the newest document begins; everything else is left to YAML::Load().
class Beginning : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { mark_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

  [[nodiscard]] const YAML::Mark& mark() const noexcept { return mark_; }

 private:
  YAML::Mark mark_;
};

void refuse_a_second(const std::string& yaml, const std::string& source_name) {
  std::istringstream text(yaml);
  YAML::Parser parser(text);
  Beginning document;
  if (!parser.HandleNextDocument(document)) return;
  const YAML::Mark first = document.mark();
  if (!parser.HandleNextDocument(document)) return;
  if (document.mark().pos == first.pos) {
    throw ConfigError(place_of(first, source_name), "a sign that begins no value",
                      "well-formed YAML");
  }
  throw ConfigError(place_of(document.mark(), source_name), "a second document", "one");
}

// The one document of a YAML text; null for an empty text.  YAML::LoadAll() of yaml-cpp 0.7 never
// returns for ", a: 1": it takes a document there that consumes nothing, for ever.
YAML::Node one_document(const std::string& yaml, const std::string& source_name) {
  try {
    refuse_a_second(yaml, source_name);
    return YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError(place_of(error.mark, source_name), error.msg, "well-formed YAML");
  }
}

// Settings have three levels and some tens of keys.  An alias inside its own anchor would never
// end, and aliases can multiply a part at every level.
constexpr int kDeepest = 16;
constexpr std::size_t kMostEntries = 10'000;

Entry converted(const YAML::Node& node, const std::string& source_name, int depth,
                std::size_t& count);

void add_children(Entry& map, const YAML::Node& node, const std::string& source_name, int depth,
                  std::size_t& count) {
  for (const auto& pair : node) {
    const std::string place = place_of(pair.first.Mark(), source_name);
    if (!pair.first.IsScalar())
      throw ConfigError(place, "a key that is not a plain word", "a plain name");
    Entry child = converted(pair.second, source_name, depth + 1, count);
    child.key = pair.first.Scalar();
    child.key_place = place;
    for (const Entry& sibling : map.children) {
      if (sibling.key == child.key) {
        throw ConfigError(place, "a second \"" + child.key + "\"",
                          "each key once; the first is at " + sibling.key_place);
      }
    }
    map.children.push_back(std::move(child));
  }
}

Entry converted(const YAML::Node& node, const std::string& source_name, int depth,
                std::size_t& count) {
  Entry entry;
  entry.place = entry.key_place = place_of(node.Mark(), source_name);
  if (depth > kDeepest || ++count > kMostEntries) {
    throw ConfigError(entry.place, "endless settings", "no alias inside its own anchor");
  }
  if (node.IsMap()) {
    entry.kind = Entry::Kind::kMap;
    add_children(entry, node, source_name, depth, count);
  } else if (node.IsSequence()) {
    entry.kind = Entry::Kind::kSequence;
    for (const auto& item : node) {
      entry.children.push_back(converted(item, source_name, depth + 1, count));
    }
  } else if (node.IsScalar()) {
    entry.kind = Entry::Kind::kScalar;
    entry.text = node.Scalar();
    entry.quoted = node.Tag() == "!";
  }
  return entry;
}

std::string shown(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string interval(Range range) {
  return "a value from " + shown(range.min) + " to " + shown(range.max);
}

// The whole text as a number; from_chars accepts no leading + and ignores the locale.
template <typename Number>
std::optional<Number> number_from(const Entry& entry) {
  if (entry.kind != Entry::Kind::kScalar || entry.quoted) return std::nullopt;
  Number value{};
  const char* begin = entry.text.data();
  const char* end = begin + entry.text.size();
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return value;
}

}  // namespace

std::string got_of(const Entry& entry) {
  switch (entry.kind) {
    case Entry::Kind::kNull:
      return "nothing";
    case Entry::Kind::kMap:
      return "a map";
    case Entry::Kind::kSequence:
      return "a list";
    case Entry::Kind::kScalar:
      break;
  }
  return entry.quoted ? "\"" + entry.text + "\"" : entry.text;
}

Entry parse_text(const std::string& yaml, const std::string& source_name) {
  const YAML::Node root = one_document(yaml, source_name);
  std::size_t count = 0;
  Entry top = converted(root, source_name, 0, count);
  if (top.kind == Entry::Kind::kNull) top.kind = Entry::Kind::kMap;
  if (top.kind != Entry::Kind::kMap) throw ConfigError(top.place, got_of(top), "a map of settings");
  return top;
}

Entry parse_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw ConfigError(file.string(), "no such file", "a YAML file of settings");
  }
  std::ifstream stream(file, std::ios::binary);
  const std::string yaml{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw ConfigError(file.string(), "an unreadable file", "a readable file");
  return parse_text(yaml, file.string());
}

SectionReader::SectionReader(const Entry& section, std::string scope)
    : section_(section), scope_(std::move(scope)) {
  if (section.kind != Entry::Kind::kMap && section.kind != Entry::Kind::kNull) {
    throw ConfigError(section.place + ": " + scope_, got_of(section), "a map of settings");
  }
}

const Entry* SectionReader::find(std::string_view name) {
  names_.emplace_back(name);
  const auto found = std::find_if(section_.children.begin(), section_.children.end(),
                                  [&](const Entry& child) { return child.key == name; });
  return found == section_.children.end() ? nullptr : &*found;
}

void SectionReader::fail(const Entry& entry, const std::string& want) const {
  const std::string& place = entry.kind == Entry::Kind::kNull ? entry.key_place : entry.place;
  throw ConfigError(place + ": " + scope_ + "." + entry.key, got_of(entry), want);
}

void SectionReader::operator()(std::string_view name, double& value, Range range,
                               std::string_view /*doc*/) {
  const Entry* entry = find(name);
  if (entry == nullptr) return;
  const auto number = number_from<double>(*entry);
  if (!number || !(*number >= range.min && *number <= range.max) || !std::isfinite(*number)) {
    fail(*entry, interval(range));
  }
  value = *number;
}

void SectionReader::operator()(std::string_view name, std::int64_t& value, Range range,
                               std::string_view /*doc*/) {
  const Entry* entry = find(name);
  if (entry == nullptr) return;
  const auto number = number_from<std::int64_t>(*entry);
  const double as_double = number ? static_cast<double>(*number) : std::nan("");
  if (!(as_double >= range.min && as_double <= range.max)) {
    fail(*entry, "a whole number, " + interval(range));
  }
  value = *number;
}

void SectionReader::operator()(std::string_view name, bool& value, Range range,
                               std::string_view /*doc*/) {
  const Entry* entry = find(name);
  if (entry == nullptr) return;
  const bool plain = entry->kind == Entry::Kind::kScalar && !entry->quoted;
  if (!plain || (entry->text != "true" && entry->text != "false")) fail(*entry, "true or false");
  const bool wanted = entry->text == "true";
  if ((wanted ? 1.0 : 0.0) < range.min || (wanted ? 1.0 : 0.0) > range.max) {
    fail(*entry, wanted ? "false" : "true");
  }
  value = wanted;
}

void SectionReader::operator()(std::string_view name, std::string& value, Range range,
                               std::string_view doc) {
  const Entry* entry = find(name);
  if (entry == nullptr) return;
  const auto length = static_cast<double>(entry->text.size());
  if (entry->kind != Entry::Kind::kScalar || !(length >= range.min && length <= range.max)) {
    // The length alone does not say which words there are.
    fail(*entry, "text of " + shown(range.min) + " to " + shown(range.max) +
                     " characters: " + std::string(doc));
  }
  value = entry->text;
}

void SectionReader::refuse_unknown() const {
  for (const Entry& child : section_.children) {
    if (std::find(names_.begin(), names_.end(), child.key) != names_.end()) continue;
    const std::vector<std::string_view> known(names_.begin(), names_.end());
    throw ConfigError(child.key_place + ": " + scope_ + "." + child.key, "an unknown key",
                      known.empty() ? "no keys here" : suggestion(child.key, known));
  }
}

}  // namespace stillhand::settings
