// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/ros2msg.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/messages/omgidl_tokens.hpp"

namespace stillhand::recording {
namespace {

constexpr int kDeepestType = 64;

struct Ros2Primitive {
  std::string_view word;
  IdlKind kind;
};
constexpr std::array<Ros2Primitive, 15> kRos2Primitives{{{"bool", IdlKind::kBoolean},
                                                         {"byte", IdlKind::kOctet},
                                                         {"char", IdlKind::kOctet},
                                                         {"int8", IdlKind::kInt8},
                                                         {"uint8", IdlKind::kOctet},
                                                         {"int16", IdlKind::kInt16},
                                                         {"uint16", IdlKind::kUint16},
                                                         {"int32", IdlKind::kInt32},
                                                         {"uint32", IdlKind::kUint32},
                                                         {"int64", IdlKind::kInt64},
                                                         {"uint64", IdlKind::kUint64},
                                                         {"float32", IdlKind::kFloat32},
                                                         {"float64", IdlKind::kFloat64},
                                                         {"string", IdlKind::kString},
                                                         {"wstring", IdlKind::kUnsupported}}};

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// One line of a definition.
struct Line {
  std::string_view text;
  std::size_t number;
};

// "package/Type" of "package/msg/Type".
std::string short_name(std::string_view name) {
  const std::size_t first = name.find('/');
  const std::size_t last = name.rfind('/');
  if (first == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, first)) + std::string(name.substr(last));
}

std::string package_of(const std::string& name) { return name.substr(0, name.find('/')); }

class Ros2Parser {
 public:
  Ros2Parser(std::string_view text, const std::string& name, const std::string& source)
      : source_(source), main_(short_name(name)) {
    cut(text);
  }

  IdlSchema parse(const std::string& name) {
    const std::uint32_t type = struct_type(main_, {main_, 1}, 0);
    std::string scoped;
    for (const char c : name) scoped += c == '/' ? std::string("::") : std::string(1, c);
    schema_.structs[schema_.types[type].of].name = scoped;
    return std::move(schema_);
  }

 private:
  [[noreturn]] void refuse(std::size_t line, const std::string& got, const std::string& want) {
    throw ConfigError(source_ + ":" + std::to_string(line), got, want);
  }

  void cut(std::string_view text) {
    std::vector<Line>* into = &sections_[main_];
    bool titled = false;  // the line before was a line of '='
    for (std::size_t number = 1; !text.empty(); ++number) {
      const std::size_t length = std::min(text.find('\n'), text.size());
      const std::string_view line = without_blanks(text.substr(0, length));
      text.remove_prefix(std::min(length + 1, text.size()));
      const bool rule = line.size() > 2 && line.find_first_not_of('=') == std::string_view::npos;
      if (titled && line.starts_with("MSG:")) {
        into = &sections_[short_name(without_blanks(line.substr(4)))];
        into->clear();
      } else if (!rule) {
        into->push_back({line, number});
      }
      titled = rule;
    }
  }

  std::uint32_t add(IdlType type) {
    schema_.types.push_back(std::move(type));
    return static_cast<std::uint32_t>(schema_.types.size() - 1);
  }

  // Every ROS 2 installation has these two; some files leave them out.
  void define_builtin(const std::string& name) {
    static constexpr std::array<std::string_view, 2> kTime{"int32 sec", "uint32 nanosec"};
    if (name != "builtin_interfaces/Time" && name != "builtin_interfaces/Duration") return;
    for (const std::string_view line : kTime) sections_[name].push_back({line, 0});
  }

  std::uint32_t struct_type(const std::string& name, const Line& user, int depth) {
    const auto known = types_.find(name);
    if (known != types_.end()) {
      if (!known->second) refuse(user.number, "the type " + name + " within itself", "other types");
      return *known->second;
    }
    if (depth > kDeepestType) refuse(user.number, "deeply nested types", "fewer of them");
    if (sections_.count(name) == 0) define_builtin(name);
    const auto section = sections_.find(name);
    if (section == sections_.end()) {
      refuse(user.number, "the type " + name, "its definition behind 'MSG: " + name + "'");
    }
    types_[name] = std::nullopt;
    IdlStruct found{name, {}, false};
    for (const Line& line : section->second) member(line, package_of(name), depth, found);
    if (found.members.empty()) {
      found.members.push_back({"structure_needs_at_least_one_member", add({IdlKind::kOctet}), {}});
    }
    const auto number = static_cast<std::uint32_t>(schema_.structs.size());
    schema_.structs.push_back(std::move(found));
    const std::uint32_t type = add({IdlKind::kStruct, number});
    types_[name] = type;
    return type;
  }

  void member(const Line& line, const std::string& package, int depth, IdlStruct& into) {
    const std::size_t comment = comment_at(line.text);
    const std::string_view code = without_blanks(line.text.substr(0, comment));
    if (code.empty()) return;
    const std::size_t blank = code.find_first_of(" \t");
    if (blank == std::string_view::npos) {
      refuse(line.number, "'" + std::string(code) + "'", "a type and a name");
    }
    const std::string_view rest = without_blanks(code.substr(blank));
    const std::size_t end = std::min(rest.find_first_of(" \t="), rest.size());
    const std::string_view behind = without_blanks(rest.substr(end));
    if (behind.starts_with('=')) return;  // a constant
    const std::string unit =
        comment < line.text.size() ? unit_in(line.text.substr(comment)) : std::string();
    const std::uint32_t type = type_of(code.substr(0, blank), line, package, depth);
    into.members.push_back({std::string(rest.substr(0, end)), type, unit});
  }

  // Place of '#', unless it is in the text of a default.
  static std::size_t comment_at(std::string_view line) {
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (quote != 0) {
        if (line[i] == quote) quote = 0;
      } else if (line[i] == '"' || line[i] == '\'') {
        quote = line[i];
      } else if (line[i] == '#') {
        return i;
      }
    }
    // An apostrophe of prose, not of a default.
    return quote == 0 ? line.size() : std::min(line.find('#'), line.size());
  }

  std::uint32_t type_of(std::string_view word, const Line& line, const std::string& package,
                        int depth) {
    const std::size_t open = word.find('[');
    const std::string_view list = open == std::string_view::npos ? "" : word.substr(open);
    std::string_view element = word.substr(0, open);
    const std::size_t bound = element.find("<=");  // of a string
    element = element.substr(0, bound);
    const std::uint32_t of = element_type(element, line, package, depth);
    if (list.empty()) return of;
    if (!list.ends_with(']')) refuse(line.number, "'" + std::string(word) + "'", "a closing ]");
    const std::string_view inside = list.substr(1, list.size() - 2);
    if (inside.empty() || inside.starts_with("<=")) return add({IdlKind::kSequence, of});
    std::uint32_t length = 0;
    const auto [end, error] = std::from_chars(inside.data(), inside.data() + inside.size(), length);
    if (error != std::errc() || end != inside.data() + inside.size() || length == 0) {
      refuse(line.number, "'" + std::string(word) + "'", "a length of at least 1");
    }
    return add({IdlKind::kArray, of, length});
  }

  std::uint32_t element_type(std::string_view word, const Line& line, const std::string& package,
                             int depth) {
    const auto primitive = std::ranges::find(kRos2Primitives, word, &Ros2Primitive::word);
    if (primitive != kRos2Primitives.end()) {
      return add({primitive->kind, 0, 0, std::string(primitive->word)});
    }
    std::string name(word);
    if (word == "Header") {
      name = "std_msgs/Header";
    } else if (word == "time" || word == "duration") {
      name = word == "time" ? "builtin_interfaces/Time" : "builtin_interfaces/Duration";
    } else if (word.find('/') == std::string_view::npos) {
      name = package + "/" + name;
    }
    return struct_type(short_name(name), line, depth + 1);
  }

  const std::string& source_;
  std::string main_;
  std::map<std::string, std::vector<Line>> sections_;
  std::map<std::string, std::optional<std::uint32_t>> types_;  // empty: it is being read
  IdlSchema schema_;
};

}  // namespace

IdlSchema parse_ros2msg(std::string_view text, const std::string& name, const std::string& source) {
  return Ros2Parser(text, name, source).parse(name);
}

}  // namespace stillhand::recording
