// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/csv_tables.hpp"

#include <array>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "apps/libraries/report/staged_folder.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::recordings {
namespace {

using recording::Cell;
using recording::CellKind;

constexpr std::size_t kBlockBytes = std::size_t{1} << 18;

template <typename Number>
void put_number(std::string& out, Number number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  out.append(text.data(), end);
}

// Exact: a double of seconds since 1970 does not resolve nanoseconds.
void put_seconds(std::string& out, std::int64_t time_ns) {
  if (time_ns < 0) out += '-';
  const auto whole = std::lldiv(time_ns, kSecond_ns);
  put_number(out, std::llabs(whole.quot));
  const std::string fraction = std::to_string(std::llabs(whole.rem));
  out.append(1, '.').append(9 - fraction.size(), '0').append(fraction);
}

void put_cell(std::string& out, const Cell& cell) {
  std::visit(
      [&]<typename Value>(const Value& value) {
        if constexpr (std::is_same_v<Value, std::string_view>) {
          out += report::csv_quoted(value);
        } else if constexpr (!std::is_same_v<Value, std::monostate>) {
          put_number(out, value);
        }
      },
      cell);
}

// A number without a stated unit may still have one.
std::string unit_of(const recording::MessageColumn& column) {
  if (!column.unit.empty()) return column.unit;
  return column.kind == CellKind::kReal ? "?" : "-";
}

class CsvSink : public TableSink {
 public:
  CsvSink(const TopicTable& table, const std::filesystem::path& path)
      : path_(path), file_(path, std::ios::binary), of_messages_(table.of_messages) {
    if (of_messages_) text_ = "t [s],log_time [ns],publish_time [ns],sequence [-]";
    for (const auto& column : table.columns) {
      if (!text_.empty()) text_ += ',';
      text_ += report::csv_quoted(column.name + " [" + unit_of(column) + "]");
    }
    text_ += '\n';
  }

  void take(const TableRow& row) override {
    if (of_messages_) {
      put_seconds(text_, row.since_start_ns);
      put_number(text_ += ',', row.log_time_ns);
      put_number(text_ += ',', row.publish_time_ns);
      put_number(text_ += ',', row.sequence);
    }
    bool first = !of_messages_;
    for (const Cell& cell : row.cells) {
      if (!first) text_ += ',';
      first = false;
      put_cell(text_, cell);
    }
    text_ += '\n';
    if (text_.size() >= kBlockBytes) write();
  }

  void finish() override {
    write();
    file_.close();
    check();
  }

 private:
  void write() {
    file_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.clear();
    check();
  }
  void check() const {
    if (!file_) throw std::runtime_error(path_.string() + ": cannot be written; is the disk full?");
  }

  std::filesystem::path path_;
  std::ofstream file_;
  bool of_messages_;
  std::string text_;
};

class CsvFolder : public TableFile {
 public:
  explicit CsvFolder(const std::filesystem::path& folder) : folder_(folder, "--csv") {}

  std::unique_ptr<TableSink> add(const TopicTable& table, std::uint64_t /*rows*/) override {
    return std::make_unique<CsvSink>(table, folder_.path() / (table.name + ".csv"));
  }
  void close() override {}  // each topic has a file of its own
  void publish() override { folder_.publish({}); }

 private:
  report::StagedFolder folder_;
};

}  // namespace

std::unique_ptr<TableFile> csv_tables(const std::filesystem::path& folder) {
  return std::make_unique<CsvFolder>(folder);
}

}  // namespace stillhand::recordings
