// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/mat_tables.hpp"

#include <matio.h>

#include <stdexcept>
#include <utility>

#include "apps/recordings/column_names.hpp"
#include "apps/recordings/pending_file.hpp"

namespace stillhand::recordings {
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

Variable empty_structure(const char* name, std::vector<const char*> fields) {
  std::size_t size[2] = {1, 1};
  return made(
      Mat_VarCreateStruct(name, 2, size, fields.data(), static_cast<unsigned>(fields.size())));
}

void set(Variable& structure, const char* field, Variable value) {
  Mat_VarSetStructFieldByName(structure.get(), field, 0, value.release());
}

/// The library's file, closed at its end.
class OpenMat {
 public:
  /// @param path  where it is made  @param place  its name in messages
  OpenMat(const std::string& path, std::string place)
      : place_(std::move(place)),
        file_(Mat_CreateVer(path.c_str(), "MATLAB 5.0 MAT-file, from a recording", MAT_FT_MAT5)) {
    check(file_ != nullptr);
  }
  ~OpenMat() {
    if (file_ != nullptr) Mat_Close(file_);
  }
  OpenMat(const OpenMat&) = delete;
  OpenMat& operator=(const OpenMat&) = delete;

  void write(const Variable& variable) {
    check(Mat_VarWrite(file_, variable.get(), MAT_COMPRESSION_ZLIB) == 0);
  }
  /// Closes now, where failing matters.
  void close() { check(Mat_Close(std::exchange(file_, nullptr)) == 0); }
  [[nodiscard]] const std::string& place() const noexcept { return place_; }

 private:
  void check(bool done) const {
    if (!done) throw std::runtime_error(place_ + ": cannot be written; is the disk full?");
  }

  std::string place_;
  mat_t* file_;
};

// Version 5 has no way to append to a variable: a topic is held until its last row.
class MatSink : public TableSink {
 public:
  MatSink(OpenMat& file, TopicTable table) : file_(file), table_(std::move(table)) {
    std::set<std::string> taken{"meta"};
    const auto add = [&](const std::string& name, const std::string& unit, CellKind kind) {
      columns_.push_back({plain_name(name, kLongestName, taken), unit, kind});
    };
    add("t", "s", CellKind::kReal);
    add("log_time", "ns", CellKind::kUnsigned);
    add("publish_time", "ns", CellKind::kUnsigned);
    add("sequence", "-", CellKind::kUnsigned);
    for (const auto& column : table_.columns) {
      add(column.name, column.unit, kind_without_gaps(column));
    }
  }

  void take(const TableRow& row) override {
    auto column = columns_.begin();
    const auto put = [&](const Cell& cell) { bytes_ += (column++)->take(cell); };
    put(static_cast<double>(row.since_start_ns) * 1e-9);
    put(row.log_time_ns);
    put(row.publish_time_ns);
    put(std::uint64_t{row.sequence});
    for (const Cell& cell : row.cells) put(cell);
    if (bytes_ < kMostBytes) return;
    throw std::runtime_error(file_.place() + ": " + table_.topic +
                             " is larger than the 2 GiB for each topic that a MATLAB file "
                             "allows: use --hdf5, which has no such limit, or --topics to leave "
                             "topics out");
  }

  void finish() override { file_.write(structure()); }

 private:
  Variable structure() {
    std::vector<const char*> names;
    for (const Held& column : columns_) names.push_back(column.name.c_str());
    Variable units = empty_structure(nullptr, names);
    Variable meta = empty_structure(nullptr, {"topic", "type", "units"});
    names.push_back("meta");
    Variable out = empty_structure(table_.name.c_str(), names);
    for (Held& column : columns_) {
      set(units, column.name.c_str(), text_variable(nullptr, column.unit));
      set(out, column.name.c_str(), column.variable());
    }
    set(meta, "topic", text_variable(nullptr, table_.topic));
    set(meta, "type", text_variable(nullptr, table_.type));
    set(meta, "units", std::move(units));
    set(out, "meta", std::move(meta));
    return out;
  }

  OpenMat& file_;
  TopicTable table_;
  std::vector<Held> columns_;
  std::size_t bytes_ = 0;
};

class MatFile : public TableFile {
 public:
  explicit MatFile(const std::string& path) : pending_(path), file_(pending_.path(), path) {}

  std::unique_ptr<TableSink> add(const TopicTable& table) override {
    return std::make_unique<MatSink>(file_, table);
  }
  void close() override { file_.close(); }
  void publish() override { pending_.publish(); }

 private:
  PendingFile pending_;
  OpenMat file_;
};

}  // namespace

std::unique_ptr<TableFile> mat_tables(const std::string& path) {
  return std::make_unique<MatFile>(path);
}

}  // namespace stillhand::recordings
