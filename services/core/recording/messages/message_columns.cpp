// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/message_columns.hpp"

#include <algorithm>

namespace stillhand::recording {
namespace {

// A spreadsheet shows 16,384 columns; a topic with more values is an image or a point cloud.
constexpr std::size_t kMostColumns = 4096;
// Limits the recursion for any chain of types in a schema.
constexpr std::size_t kMostDepth = 64;

Cell take_leaf(IdlKind kind, CdrReader& in) {
  switch (kind) {
    case IdlKind::kBoolean:
    case IdlKind::kOctet:
      return std::uint64_t{in.take<std::uint8_t>()};
    case IdlKind::kInt8:
      return std::int64_t{in.take<std::int8_t>()};
    case IdlKind::kInt16:
      return std::int64_t{in.take<std::int16_t>()};
    case IdlKind::kUint16:
      return std::uint64_t{in.take<std::uint16_t>()};
    case IdlKind::kInt32:
    case IdlKind::kEnum:
      return std::int64_t{in.take<std::int32_t>()};
    case IdlKind::kUint32:
      return std::uint64_t{in.take<std::uint32_t>()};
    case IdlKind::kInt64:
      return in.take<std::int64_t>();
    case IdlKind::kUint64:
      return in.take<std::uint64_t>();
    case IdlKind::kFloat32:
      return double{in.take<float>()};
    case IdlKind::kFloat64:
      return in.take<double>();
    case IdlKind::kChar:
      return std::int64_t{in.take<std::int8_t>()};
    case IdlKind::kString:
      return in.take_text();
    default:
      return {};
  }
}

CellKind cell_kind(IdlKind kind) {
  switch (kind) {
    case IdlKind::kBoolean:
    case IdlKind::kOctet:
    case IdlKind::kUint16:
    case IdlKind::kUint32:
    case IdlKind::kUint64:
      return CellKind::kUnsigned;
    case IdlKind::kFloat32:
    case IdlKind::kFloat64:
      return CellKind::kReal;
    case IdlKind::kString:
      return CellKind::kText;
    default:
      return CellKind::kInteger;
  }
}

bool is_one_value(IdlKind kind) {
  return kind != IdlKind::kStruct && kind != IdlKind::kArray && kind != IdlKind::kSequence;
}

}  // namespace

MessageColumns::MessageColumns(const IdlSchema& schema, const IdlStruct& type) : schema_(schema) {
  root_.type.kind = IdlKind::kStruct;
  root_.type.of = static_cast<std::uint32_t>(&type - schema.structs.data());
  build(root_);
}

void MessageColumns::refuse(const std::string& why) {
  if (trouble_.empty()) trouble_ = why;
}

void MessageColumns::add_part(Node& node, std::uint32_t type, std::string path, std::string unit) {
  node.parts.push_back(
      {schema_.types[type], std::move(path), std::move(unit), node.depth + 1, 0, {}});
  build(node.parts.back());
}

void MessageColumns::build(Node& node) {
  if (!trouble_.empty()) return;
  if (++nodes_ > kMostColumns || node.depth > kMostDepth) {
    refuse("more than " + std::to_string(kMostColumns) + " values, or nested deeper than " +
           std::to_string(kMostDepth) + ", at '" + node.path + "'");
  } else if (node.type.kind == IdlKind::kUnsupported) {
    refuse("'" + node.path + "' has a kind that is not decoded: " + node.type.name);
  } else if (node.type.kind == IdlKind::kSequence) {
    has_lists_ = true;
  } else if (node.type.kind == IdlKind::kArray) {
    for (std::uint32_t i = 0; i < node.type.length && trouble_.empty(); ++i) add_element(node);
  } else if (node.type.kind == IdlKind::kStruct) {
    const IdlStruct& type = schema_.structs[node.type.of];
    if (type.is_mutable) refuse("struct " + type.name + " is @mutable, which is not decoded");
    for (const IdlMember& member : type.members) {
      const std::string path = (node.path.empty() ? "" : node.path + ".") + member.name;
      if (member.optional) refuse("'" + path + "' is @optional, which is not decoded");
      if (!trouble_.empty()) return;
      add_part(node, member.type, path, member.unit);
    }
  }
}

void MessageColumns::add_element(Node& list) {
  add_part(list, list.type.of, list.path + "." + std::to_string(list.parts.size()), list.unit);
}

// In XCDR2, a byte count precedes every list of non-primitive values.
bool MessageColumns::skip_head(const Node& list, CdrReader& in) const {
  const IdlKind element = schema_.types[list.type.of].kind;
  const bool primitive =
      is_one_value(element) && element != IdlKind::kString && element != IdlKind::kEnum;
  if (in.second_edition() && !primitive) (void)in.take<std::uint32_t>();
  return in.ok();
}

bool MessageColumns::grow(Node& node, CdrReader& in) {
  if (is_one_value(node.type.kind)) {
    (void)take_leaf(node.type.kind, in);
    return in.ok();
  }
  std::size_t count = node.parts.size();
  if (node.type.kind != IdlKind::kStruct && !skip_head(node, in)) return false;
  if (node.type.kind == IdlKind::kSequence) {
    count = in.take<std::uint32_t>();
    // An element has at least one byte, so a count larger than the message is false.
    if (count > in.left()) return false;
    while (node.parts.size() < count && trouble_.empty()) add_element(node);
    if (!trouble_.empty()) return true;  // the caller reads no row
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!grow(node.parts[i], in)) return false;
  }
  return in.ok();
}

bool MessageColumns::learn(std::span<const std::byte> message) {
  CdrReader in(message);
  return trouble_.empty() && in.ok() && grow(root_, in);
}

void MessageColumns::number(Node& node, bool in_list) {
  node.column = columns_.size();
  const bool is_list = node.type.kind == IdlKind::kSequence;
  if (is_list) {
    columns_.push_back({node.path + ".count", "-", CellKind::kUnsigned, in_list});
  } else if (node.type.kind == IdlKind::kEnum) {
    columns_.push_back({node.path, node.unit, CellKind::kInteger, in_list});
    columns_.push_back({node.path + ".name", "-", CellKind::kText, in_list});
  } else if (is_one_value(node.type.kind)) {
    columns_.push_back({node.path, node.unit, cell_kind(node.type.kind), in_list});
  }
  for (Node& part : node.parts) number(part, in_list || is_list);
}

void MessageColumns::settle() {
  columns_.clear();
  number(root_, false);
}

bool MessageColumns::fill(const Node& node, CdrReader& in, std::vector<Cell>& row) const {
  if (is_one_value(node.type.kind)) {
    row[node.column] = take_leaf(node.type.kind, in);
    if (node.type.kind == IdlKind::kEnum) {
      const auto& values = schema_.enums[node.type.of].values;
      const auto found = std::ranges::find(values, std::get<std::int64_t>(row[node.column]),
                                           &std::pair<std::int64_t, std::string>::first);
      if (found != values.end()) row[node.column + 1] = std::string_view(found->second);
    }
    return in.ok();
  }
  std::size_t count = node.parts.size();
  if (node.type.kind != IdlKind::kStruct && !skip_head(node, in)) return false;
  if (node.type.kind == IdlKind::kSequence) {
    count = in.take<std::uint32_t>();
    if (count > node.parts.size()) return false;
    row[node.column] = std::uint64_t{count};
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!fill(node.parts[i], in, row)) return false;
  }
  return in.ok();
}

bool MessageColumns::read(std::span<const std::byte> message, std::vector<Cell>& row,
                          std::size_t* behind) const {
  constexpr std::size_t kPadding = 3;
  CdrReader in(message);
  row.assign(columns_.size(), Cell{});
  if (!in.ok() || !fill(root_, in, row)) return false;
  if (behind != nullptr) *behind = in.left() > kPadding ? in.left() : 0;
  return true;
}

}  // namespace stillhand::recording
