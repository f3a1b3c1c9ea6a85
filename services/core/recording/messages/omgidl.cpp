// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/omgidl.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/messages/omgidl_cursor.hpp"
#include "services/core/recording/messages/omgidl_names.hpp"
#include "services/core/recording/messages/omgidl_numbers.hpp"

namespace stillhand::recording {
namespace {

// Limit of nested sequences and modules; a deeper text would exhaust the stack.
constexpr int kMaxDepth = 64;

struct Primitive {
  std::string_view words;
  IdlKind kind;
};
constexpr std::array<Primitive, 22> kPrimitives{
    {{"boolean", IdlKind::kBoolean},   {"octet", IdlKind::kOctet},
     {"uint8", IdlKind::kOctet},       {"int8", IdlKind::kInt8},
     {"char", IdlKind::kChar},         {"short", IdlKind::kInt16},
     {"int16", IdlKind::kInt16},       {"unsigned short", IdlKind::kUint16},
     {"uint16", IdlKind::kUint16},     {"long", IdlKind::kInt32},
     {"int32", IdlKind::kInt32},       {"unsigned long", IdlKind::kUint32},
     {"uint32", IdlKind::kUint32},     {"long long", IdlKind::kInt64},
     {"int64", IdlKind::kInt64},       {"unsigned long long", IdlKind::kUint64},
     {"uint64", IdlKind::kUint64},     {"float", IdlKind::kFloat32},
     {"double", IdlKind::kFloat64},    {"long double", IdlKind::kUnsupported},
     {"wchar", IdlKind::kUnsupported}, {"any", IdlKind::kUnsupported}}};

// Annotations of a definition.
struct Marks {
  bool key = false;
  bool optional = false;
  bool is_mutable = false;
  std::optional<std::int64_t> value = {};
  std::string unit = {};
};

// Recursive descent over the tokens, with one method for each rule of the grammar.
class Parser {
 public:
  Parser(std::string_view text, const std::string& source) : in_(text, source) {}

  IdlSchema parse() {
    while (!in_.peek().empty()) definition(0);
    return std::move(schema_);
  }

 private:
  std::uint32_t add(IdlType type) {
    schema_.types.push_back(std::move(type));
    return static_cast<std::uint32_t>(schema_.types.size() - 1);
  }

  // Types
  std::uint32_t length() {
    const std::int64_t value = whole_number(in_, names_);
    if (value <= 0) in_.refuse("a length of at least 1");
    return static_cast<std::uint32_t>(value);
  }
  std::uint32_t type(int depth) {
    if (depth > kMaxDepth) in_.refuse("fewer nested types");
    if (in_.accept("string") || in_.accept("wstring")) {
      const bool wide = in_.peek(-1) == "wstring";
      if (in_.accept("<")) {
        (void)length();
        in_.expect(">");
      }
      return add(wide ? IdlType{IdlKind::kUnsupported, 0, 0, "wstring"}
                      : IdlType{IdlKind::kString});
    }
    if (in_.accept("sequence")) {
      in_.expect("<");
      const std::uint32_t element = type(depth + 1);
      if (in_.accept(",")) (void)length();
      in_.expect(">");
      return add({IdlKind::kSequence, element});
    }
    if (in_.accept("map")) {
      while (!in_.accept(">")) {
        if (in_.take().empty()) in_.refuse(">");
      }
      return add({IdlKind::kUnsupported, 0, 0, "map"});
    }
    return primitive_or_name();
  }
  std::uint32_t primitive_or_name() {
    // The longest run of words that names a primitive type: "unsigned long long".
    std::string words;
    const Primitive* best = nullptr;
    std::size_t end = in_.place();
    for (std::size_t ahead = 0; ahead < 3; ++ahead) {
      const std::string_view word = in_.peek(static_cast<std::ptrdiff_t>(ahead));
      words += (words.empty() ? "" : " ") + std::string(word);
      const auto found = std::ranges::find(kPrimitives, words, &Primitive::words);
      if (found == kPrimitives.end()) continue;
      best = found;
      end = in_.place() + ahead + 1;
    }
    if (best != nullptr) {
      in_.go_to(end);
      return add({best->kind, 0, 0, std::string(best->words)});
    }
    const std::size_t start = in_.place();
    const std::uint32_t* named = names_.type(in_.scoped_name());
    if (named == nullptr) {
      in_.go_to(start);
      in_.refuse("a type defined earlier");
    }
    return *named;
  }
  // `name` and its array brackets, over a type
  std::pair<std::string, std::uint32_t> declarator(std::uint32_t type) {
    std::string declared = in_.name();
    std::vector<std::uint32_t> lengths;
    while (in_.accept("[")) {
      lengths.push_back(length());
      in_.expect("]");
    }
    for (auto length = lengths.rbegin(); length != lengths.rend(); ++length) {
      type = add({IdlKind::kArray, type, *length});
    }
    return {std::move(declared), type};
  }

  // Definitions
  Marks marks() {
    Marks marks;
    while (in_.accept("@")) {
      const std::string name = in_.scoped_name();
      const std::size_t open = in_.place();
      if (in_.peek() == "(") in_.skip_balanced();
      const std::string_view argument = in_.place() > open + 2 ? in_.peek(-2) : "";
      if (name == "key") marks.key = argument != "FALSE" && argument != "false";
      if (name == "optional") marks.optional = argument != "FALSE" && argument != "false";
      if (name == "mutable" || (name == "extensibility" && argument == "MUTABLE")) {
        marks.is_mutable = true;
      }
      if (name == "unit" && argument.size() > 2) {
        marks.unit = argument.substr(1, argument.size() - 2);
      }
      if (name == "value" && in_.place() > open) {
        const std::size_t behind = in_.place();
        in_.go_to(open + 1);
        marks.value = whole_number(in_, names_);
        in_.go_to(behind);
      }
    }
    return marks;
  }
  void definition(int depth) {
    if (depth > kMaxDepth) in_.refuse("fewer nested modules");
    if (in_.accept(";")) return;
    if (in_.peek() == "@" && in_.peek(1) == "annotation") {
      in_.go_to(in_.place() + 2);
      in_.skip_definition();
      return;
    }
    const Marks in_front = marks();
    if (in_.accept("module")) {
      module(depth);
    } else if (in_.accept("struct")) {
      structure(in_front);
    } else if (in_.accept("enum")) {
      enumeration();
    } else if (in_.accept("typedef")) {
      const std::uint32_t aliased = type(0);
      do {
        auto [declared, of] = declarator(aliased);
        names_.set_type(names_.scoped(declared), of);
      } while (in_.accept(","));
      in_.expect(";");
    } else if (in_.accept("const")) {
      constant();
    } else {
      beyond();
    }
  }
  void module(int depth) {
    const std::string outside = names_.enter(in_.name());
    in_.expect("{");
    while (!in_.accept("}")) {
      if (in_.peek().empty()) in_.refuse("}");
      definition(depth + 1);
    }
    in_.accept(";");
    names_.leave_to(outside);
  }
  void constant() {
    while (in_.peek(1) != "=") {
      if (in_.take().empty()) in_.refuse("=");
    }
    const std::string constant = names_.scoped(in_.name());
    in_.expect("=");
    const std::size_t start = in_.place();
    try {
      const std::int64_t value = whole_number(in_, names_);
      if (in_.peek() == ";") names_.set_constant(constant, value);
    } catch (const ConfigError&) {
      in_.go_to(start);  // a text or a fraction; no length uses it
    }
    in_.skip_definition();
  }
  void enumeration() {
    IdlEnum found{names_.scoped(in_.name()), {}};
    in_.expect("{");
    std::int64_t next = 0;
    while (!in_.accept("}")) {
      const Marks in_front = marks();
      next = in_front.value.value_or(next);
      std::string value = in_.name();
      names_.set_constant(names_.scoped(value), next);
      found.values.emplace_back(next++, std::move(value));
      if (!in_.accept(",") && in_.peek() != "}") in_.refuse(", or }");
    }
    in_.expect(";");
    names_.set_type(found.name,
                    add({IdlKind::kEnum, static_cast<std::uint32_t>(schema_.enums.size())}));
    schema_.enums.push_back(std::move(found));
  }
  void structure(const Marks& in_front) {
    IdlStruct found{names_.scoped(in_.name()), {}, in_front.is_mutable};
    if (in_.accept(";")) return;  // a forward declaration
    if (in_.accept(":")) {
      const std::size_t start = in_.place();
      const std::uint32_t* base = names_.type(in_.scoped_name());
      if (base == nullptr || schema_.types[*base].kind != IdlKind::kStruct) {
        in_.go_to(start);
        in_.refuse("a struct defined earlier");
      }
      found.members = schema_.structs[schema_.types[*base].of].members;
    }
    in_.expect("{");
    while (!in_.accept("}")) members(found);
    in_.expect(";");
    names_.set_type(found.name,
                    add({IdlKind::kStruct, static_cast<std::uint32_t>(schema_.structs.size())}));
    schema_.structs.push_back(std::move(found));
  }
  void members(IdlStruct& into) {
    const Marks in_front = marks();
    const std::uint32_t of = type(0);
    const std::size_t first = into.members.size();
    do {
      auto [declared, type] = declarator(of);
      into.members.push_back({std::move(declared), type, {}, in_front.key, in_front.optional});
    } while (in_.accept(","));
    const std::string unit = in_front.unit.empty() ? unit_in(in_.comment_here()) : in_front.unit;
    in_.expect(";");
    for (std::size_t i = first; i < into.members.size(); ++i) into.members[i].unit = unit;
  }
  // Unsupported kinds of definition: their names are kept for messages.
  void beyond() {
    constexpr std::array<std::string_view, 8> kKinds{
        "union", "bitmask", "bitset", "interface", "native", "exception", "valuetype", "abstract"};
    const std::string kind(in_.peek());
    if (std::ranges::find(kKinds, kind) == kKinds.end()) {
      in_.refuse("module, struct, enum, typedef or const");
    }
    in_.take();
    const std::string declared = names_.scoped(in_.name());
    names_.set_type(declared, add({IdlKind::kUnsupported, 0, 0, kind + " " + declared}));
    in_.skip_definition();
  }

  IdlCursor in_;
  IdlNames names_;
  IdlSchema schema_;
};

}  // namespace

const IdlStruct* IdlSchema::find(std::string_view name) const {
  std::string wanted;
  for (const char c : name) wanted += c == '/' ? std::string("::") : std::string(1, c);
  const auto found = std::ranges::find(structs, wanted, &IdlStruct::name);
  return found == structs.end() ? nullptr : &*found;
}

IdlSchema parse_idl(std::string_view text, const std::string& source) {
  return Parser(text, source).parse();
}

}  // namespace stillhand::recording
