// SPDX-License-Identifier: Apache-2.0
#include "recorder/mat_tables.hpp"

#include <matio.h>

#include <list>
#include <stdexcept>

#include "recorder/column_names.hpp"
#include "recorder/pending_file.hpp"

namespace stillhand::recorder {
namespace {

using recording::Cell;
using recording::CellKind;

constexpr std::size_t kLongestName = 63;  // namelengthmax of MATLAB
// A variable of version 5 counts its bytes in 32 bits; MATLAB takes 2 GiB.
constexpr std::size_t kMostBytes = std::size_t{1} << 31;

struct MatFree {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, MatFree>;

Variable made(matvar_t* variable) {
  if (variable == nullptr) throw std::bad_alloc();
  return Variable(variable);
}

Variable text_variable(const char* name, const std::string& text) {
  std::size_t size[2] = {text.empty() ? 0u : 1u, text.size()};
  std::string bytes = text;
  return made(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, size, bytes.data(), 0));
}

template <typename Number>
Variable numbers(const char* name, matio_classes kind, matio_types type,
                 std::vector<Number>& values) {
  std::size_t size[2] = {values.size(), 1};
  Number none{};
  return made(Mat_VarCreate(name, kind, type, 2, size, values.empty() ? &none : values.data(), 0));
}

// One column until the file is written.
struct Held {
  std::string name;
  std::string unit;
  CellKind kind;
  std::vector<std::int64_t> integers = {};
  std::vector<std::uint64_t> unsigneds = {};
  std::vector<double> reals = {};
  std::vector<std::string> texts = {};

  std::size_t take(const Cell& cell) {
    switch (kind) {
      case CellKind::kInteger:
        integers.push_back(std::get<std::int64_t>(cell));
        return sizeof(std::int64_t);
      case CellKind::kUnsigned:
        unsigneds.push_back(std::get<std::uint64_t>(cell));
        return sizeof(std::uint64_t);
      case CellKind::kReal:
        reals.push_back(real_of(cell));
        return sizeof(double);
      case CellKind::kText:
        texts.emplace_back(std::holds_alternative<std::string_view>(cell)
                               ? std::get<std::string_view>(cell)
                               : std::string_view());
        return texts.back().size() + 64;  // head of a cell and of its text
    }
    return 0;
  }

  [[nodiscard]] Variable variable() {
    switch (kind) {
      case CellKind::kInteger:
        return numbers(name.c_str(), MAT_C_INT64, MAT_T_INT64, integers);
      case CellKind::kUnsigned:
        return numbers(name.c_str(), MAT_C_UINT64, MAT_T_UINT64, unsigneds);
      case CellKind::kReal:
        return numbers(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, reals);
      case CellKind::kText:
        break;
    }
    std::size_t size[2] = {texts.size(), 1};
    Variable cells = made(Mat_VarCreate(name.c_str(), MAT_C_CELL, MAT_T_CELL, 2, size, nullptr, 0));
    for (std::size_t i = 0; i < texts.size(); ++i) {
      Mat_VarSetCell(cells.get(), static_cast<int>(i), text_variable(nullptr, texts[i]).release());
    }
    return cells;
  }
};

struct HeldTable {
  TopicTable table;
  std::vector<Held> columns = {};
  std::size_t bytes = 0;
};

class MatSink : public TableSink {
 public:
  MatSink(HeldTable& held, const std::string& path) : held_(held), path_(path) {
    std::set<std::string> taken{"meta"};
    const auto add = [&](const std::string& name, const std::string& unit, CellKind kind) {
      held_.columns.push_back({plain_name(name, kLongestName, taken), unit, kind});
    };
    add("t", "s", CellKind::kReal);
    add("log_time", "ns", CellKind::kUnsigned);
    add("publish_time", "ns", CellKind::kUnsigned);
    add("sequence", "-", CellKind::kUnsigned);
    for (const auto& column : held.table.columns) {
      add(column.name, column.unit, kind_without_gaps(column));
    }
  }

  void take(const TableRow& row) override {
    auto column = held_.columns.begin();
    const auto put = [&](const Cell& cell) { held_.bytes += (column++)->take(cell); };
    put(static_cast<double>(row.since_start_ns) * 1e-9);
    put(row.log_time_ns);
    put(row.publish_time_ns);
    put(std::uint64_t{row.sequence});
    for (const Cell& cell : row.cells) put(cell);
    if (held_.bytes < kMostBytes) return;
    throw std::runtime_error(path_ + ": " + held_.table.topic +
                             " is larger than a MATLAB file holds (2 GiB a topic); --hdf5 has no "
                             "such bound, --topics leaves topics out");
  }
  void finish() override {}

 private:
  HeldTable& held_;
  const std::string& path_;
};

class MatFile : public TableFile {
 public:
  explicit MatFile(const std::string& path) : path_(path), pending_(path) {}

  std::unique_ptr<TableSink> add(const TopicTable& table) override {
    HeldTable& held = tables_.emplace_back(HeldTable{table});
    return std::make_unique<MatSink>(held, path_);
  }

  void publish() override {
    mat_t* file = Mat_CreateVer(pending_.path().c_str(), "MATLAB 5.0 MAT-file, from a recording",
                                MAT_FT_MAT5);
    bool done = file != nullptr;
    for (HeldTable& held : tables_) {
      if (done) done = Mat_VarWrite(file, structure(held).get(), MAT_COMPRESSION_ZLIB) == 0;
      held.columns.clear();
    }
    if (file != nullptr && Mat_Close(file) != 0) done = false;
    if (!done) throw std::runtime_error(path_ + ": cannot be written; is the disk full?");
    pending_.publish();
  }

 private:
  static Variable empty_structure(const char* name, std::vector<const char*> fields) {
    std::size_t size[2] = {1, 1};
    return made(
        Mat_VarCreateStruct(name, 2, size, fields.data(), static_cast<unsigned>(fields.size())));
  }

  static Variable structure(HeldTable& held) {
    std::vector<const char*> columns;
    for (const Held& column : held.columns) columns.push_back(column.name.c_str());
    Variable units = empty_structure(nullptr, columns);
    Variable meta = empty_structure(nullptr, {"topic", "type", "units"});
    columns.push_back("meta");
    Variable out = empty_structure(held.table.name.c_str(), columns);
    const auto set = [](Variable& into, const char* name, Variable value) {
      Mat_VarSetStructFieldByName(into.get(), name, 0, value.release());
    };
    for (Held& column : held.columns) {
      set(units, column.name.c_str(), text_variable(nullptr, column.unit));
      set(out, column.name.c_str(), column.variable());
    }
    set(meta, "topic", text_variable(nullptr, held.table.topic));
    set(meta, "type", text_variable(nullptr, held.table.type));
    set(meta, "units", std::move(units));
    set(out, "meta", std::move(meta));
    return out;
  }

  std::string path_;
  PendingFile pending_;
  std::list<HeldTable> tables_;  // sinks point at them
};

}  // namespace

std::unique_ptr<TableFile> mat_tables(const std::string& path) {
  return std::make_unique<MatFile>(path);
}

}  // namespace stillhand::recorder
