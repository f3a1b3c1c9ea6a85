// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/core/recording/messages/cdr_reader.hpp"
#include "services/core/recording/messages/omgidl.hpp"

namespace stillhand::recording {

/// Kind of the values of a column.
enum class CellKind : std::uint8_t { kInteger, kUnsigned, kReal, kText };

/// One value of a message, flat.
struct MessageColumn {
  std::string name;  ///< "a", of a struct "a.b", of a list "a.0", "a.1"; "a.count"; of an enum
                     ///< "a" and "a.name"
  std::string unit;  ///< empty: none stated
  CellKind kind = CellKind::kReal;
  bool in_list = false;  ///< empty if a list is shorter
};

/// Nothing (after the end of a list), or a value of the column's kind.  Texts point into the
/// message or the schema.
using Cell = std::variant<std::monostate, std::int64_t, std::uint64_t, double, std::string_view>;

/// The messages of one type as rows of a table.  A list of free length has as many columns as the
/// longest list in the messages.  Call learn() for every message, then settle(), then read().
///
/// The schema must outlive it.  Thread-compatible.
class MessageColumns {
 public:
  /// @param type  struct of `schema`
  MessageColumns(const IdlSchema& schema, const IdlStruct& type);

  /// Reason why these messages cannot be decoded or have too many columns; empty: none.
  [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }
  /// False if every message has the same columns; learn() is then not necessary.
  [[nodiscard]] bool has_lists() const noexcept { return has_lists_; }
  /// Notes the lengths of the lists.  @returns false if it is not a message of this type.
  bool learn(std::span<const std::byte> message);
  /// Numbers the columns.
  void settle();
  [[nodiscard]] const std::vector<MessageColumn>& columns() const noexcept { return columns_; }
  /// Fills `row` with one cell for each column.  @returns false if it is not a message of this type
  /// or a list is longer than learned.
  /// @param behind  bytes that follow the members, beyond the padding to four
  bool read(std::span<const std::byte> message, std::vector<Cell>& row,
            std::size_t* behind = nullptr) const;

 private:
  struct Node {  // a value and its parts
    IdlType type;
    std::string path;
    std::string unit;
    std::size_t depth = 0;
    std::size_t column = 0;
    std::vector<Node> parts = {};  // members, or elements
  };

  void build(Node& node);
  void add_part(Node& node, std::uint32_t type, std::string path, std::string unit);
  void add_element(Node& list);
  bool grow(Node& node, CdrReader& in);
  void number(Node& node, bool in_list);
  bool fill(const Node& node, CdrReader& in, std::vector<Cell>& row) const;
  bool skip_head(const Node& list, CdrReader& in) const;
  void refuse(const std::string& why);

  const IdlSchema& schema_;
  Node root_;
  std::string trouble_;
  bool has_lists_ = false;
  std::size_t nodes_ = 0;
  std::vector<MessageColumn> columns_;
};

}  // namespace stillhand::recording
