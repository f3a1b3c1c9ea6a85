// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/guarded_table.hpp"

#include <utility>

#include "apps/libraries/measurement/tables/in_child.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::uint64_t kWidestTable = 100'000;
constexpr std::uint64_t kMostNotes = 1000;
constexpr std::uint64_t kMostRows = std::uint64_t{1} << 40;

void put_notes(Wire& wire, const std::vector<std::string>& notes) {
  wire.put(std::uint64_t{notes.size()});
  for (const std::string& note : notes) wire.put(note);
}

std::vector<std::string> get_notes(Wire& wire) {
  std::vector<std::string> notes(wire.get_count(kMostNotes));
  for (std::string& note : notes) note = wire.get_text();
  return notes;
}

void put_head(Wire& wire, const TableHead& head) {
  if (head.columns.size() > kWidestTable) {
    throw Refused{head.path, std::to_string(head.columns.size()) + " columns",
                  "at most " + std::to_string(kWidestTable)};
  }
  wire.put(head.form);
  wire.put(head.rate_hz);
  put_notes(wire, head.notes);
  wire.put(std::uint64_t{head.columns.size()});
  for (const ColumnHead& column : head.columns) {
    wire.put(column.title);
    wire.put(column.name);
    wire.put(column.unit);
    wire.put(std::uint64_t{column.rows});
  }
}

TableHead get_head(Wire& wire, const std::string& path) {
  TableHead head;
  head.path = path;
  head.form = wire.get_text();
  head.rate_hz = wire.get_number();
  head.notes = get_notes(wire);
  head.columns.resize(wire.get_count(kWidestTable));
  for (ColumnHead& column : head.columns) {
    column.title = wire.get_text();
    column.name = wire.get_text();
    column.unit = wire.get_text();
    column.rows = wire.get_count(kMostRows);
  }
  return head;
}

class GuardedTable : public TableFile {
 public:
  GuardedTable(TableHead head, BinaryReader reader, std::size_t most_values)
      : TableFile(std::move(head)), reader_(std::move(reader)), most_values_(most_values) {}

  RawColumns read(const std::vector<std::size_t>& columns) override {
    const std::vector<ColumnHead>& heads = head().columns;
    const ColumnHead& first = heads.at(columns.at(0));
    for (const std::size_t column : columns) {
      if (heads.at(column).rows != first.rows) {
        throw ConfigError(head().path,
                          std::to_string(first.rows) + " values of '" + first.title + "' and " +
                              std::to_string(heads[column].rows) + " of '" + heads[column].title +
                              "'",
                          "columns of one length; --map those that belong together");
      }
    }
    if (first.rows > most_values_ / columns.size()) {
      throw ConfigError(
          head().path,
          std::to_string(first.rows) + " rows of " + std::to_string(columns.size()) + " channels",
          "at most " + std::to_string(most_values_) +
              " values; use a part of the file, fewer columns or a lower rate");
    }
    RawColumns out;
    in_child(
        head().path,
        [&](Wire& wire) {
          const RawColumns values = reader_.read(head().path, head(), columns);
          put_notes(wire, values.notes);
          for (const std::vector<double>& column : values.values) wire.put(column);
        },
        [&](Wire& wire) {
          out.notes = get_notes(wire);
          for (std::size_t i = 0; i < columns.size(); ++i) {
            out.values.push_back(wire.get_numbers(first.rows));
          }
        });
    return out;
  }

 private:
  BinaryReader reader_;
  std::size_t most_values_;
};

}  // namespace

std::unique_ptr<TableFile> guarded_table(const std::string& path, BinaryReader reader,
                                         std::size_t most_values) {
  TableHead head;
  in_child(
      path, [&](Wire& wire) { put_head(wire, reader.head(path)); },
      [&](Wire& wire) { head = get_head(wire, path); });
  return std::make_unique<GuardedTable>(std::move(head), std::move(reader), most_values);
}

}  // namespace stillhand::measurement
