// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/held_columns.hpp"

#include <string_view>
#include <variant>

#include "apps/recordings/column_names.hpp"

namespace stillhand::recordings {

using recording::CellKind;

std::vector<ColumnHead> column_heads(const TopicTable& table, std::size_t longest,
                                     std::set<std::string> taken) {
  std::vector<ColumnHead> heads;
  heads.reserve(table.columns.size() + 4);
  const auto add = [&](const std::string& name, const std::string& unit, CellKind kind) {
    heads.push_back({plain_name(name, longest, taken), unit, kind});
  };
  if (table.of_messages) {
    add("t", "s", CellKind::kReal);
    add("log_time", "ns", CellKind::kUnsigned);
    add("publish_time", "ns", CellKind::kUnsigned);
    add("sequence", "-", CellKind::kUnsigned);
  }
  for (const auto& column : table.columns) {
    add(column.name, column.unit, kind_without_gaps(column));
  }
  return heads;
}

void HeldColumn::take(const recording::Cell& cell) {
  switch (kind) {
    case CellKind::kInteger:
      integers.push_back(std::get<std::int64_t>(cell));
      break;
    case CellKind::kUnsigned:
      unsigneds.push_back(std::get<std::uint64_t>(cell));
      break;
    case CellKind::kReal:
      reals.push_back(real_of(cell));
      break;
    case CellKind::kText:
      texts.emplace_back(std::holds_alternative<std::string_view>(cell)
                             ? std::get<std::string_view>(cell)
                             : std::string_view());
      break;
  }
}

void HeldColumn::clear() {
  integers.clear();
  unsigneds.clear();
  reals.clear();
  texts.clear();
}

}  // namespace stillhand::recordings
