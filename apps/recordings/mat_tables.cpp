// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/mat_tables.hpp"

#include <matio.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "apps/recordings/held_columns.hpp"
#include "apps/recordings/pending_file.hpp"

namespace stillhand::recordings {
namespace {

using recording::Cell;
using recording::CellKind;

constexpr std::size_t kLongestMatName = 63;  // namelengthmax of MATLAB
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

// Bytes that the newest value of a column adds to a variable.
std::size_t newest_bytes(const HeldColumn& column) {
  constexpr std::size_t kNumber = 8;
  constexpr std::size_t kHeads = 64;  // of a cell and of its text
  return column.kind == CellKind::kText ? column.texts.back().size() + kHeads : kNumber;
}

Variable variable(const char* name, HeldColumn& column) {
  switch (column.kind) {
    case CellKind::kInteger:
      return numbers(name, MAT_C_INT64, MAT_T_INT64, column.integers);
    case CellKind::kUnsigned:
      return numbers(name, MAT_C_UINT64, MAT_T_UINT64, column.unsigneds);
    case CellKind::kReal:
      return numbers(name, MAT_C_DOUBLE, MAT_T_DOUBLE, column.reals);
    case CellKind::kText:
      break;
  }
  std::size_t size[2] = {column.texts.size(), 1};
  Variable cells = made(Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, size, nullptr, 0));
  for (std::size_t i = 0; i < column.texts.size(); ++i) {
    Mat_VarSetCell(cells.get(), static_cast<int>(i),
                   text_variable(nullptr, column.texts[i]).release());
  }
  return cells;
}

Variable empty_structure(const char* name, std::vector<const char*> fields) {
  std::size_t size[2] = {1, 1};
  return made(
      Mat_VarCreateStruct(name, 2, size, fields.data(), static_cast<unsigned>(fields.size())));
}

void set(Variable& structure, const char* field, Variable value) {
  Mat_VarSetStructFieldByName(structure.get(), field, 0, value.release());
}

// Elements of a MATLAB 5 file that are there from the first byte to the last, none where the file
// ends within one: the library does not look at what its writes return.  A head of 128 bytes, then
// a tag of two 32-bit numbers, type and bytes, before each element.  Source: MathWorks, "MAT-File
// Format", Level 5.
std::size_t elements(const std::string& path) {
  constexpr std::uintmax_t kHead = 128;
  const std::uintmax_t size = std::filesystem::file_size(path);
  std::ifstream file(path, std::ios::binary);
  std::size_t count = 0;
  std::uintmax_t at = kHead;
  while (at < size) {
    std::array<std::uint32_t, 2> tag{};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(tag.data()), sizeof tag);
    if (!file) return 0;
    at += sizeof tag + tag[1];
    ++count;
  }
  return at == size ? count : 0;
}

/// The library's file, closed at its end.
class OpenMat {
 public:
  /// @param path  where it is made  @param place  its name in messages
  OpenMat(const std::string& path, std::string place)
      : path_(path),
        place_(std::move(place)),
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
    ++written_;
  }
  /// Closes now, where failing matters.
  void close() {
    check(Mat_Close(std::exchange(file_, nullptr)) == 0);
    check(elements(path_) == written_);
  }
  [[nodiscard]] const std::string& place() const noexcept { return place_; }

 private:
  void check(bool done) const {
    if (!done) throw std::runtime_error(place_ + ": cannot be written; is the disk full?");
  }

  std::string path_;
  std::string place_;
  mat_t* file_;
  std::size_t written_ = 0;
};

// Version 5 has no way to append to a variable: a topic is held until its last row.
class MatSink : public TableSink {
 public:
  MatSink(OpenMat& file, TopicTable table)
      : file_(file),
        table_(std::move(table)),
        heads_(column_heads(table_, kLongestMatName, {"meta"})) {
    for (const ColumnHead& head : heads_) columns_.push_back({head.kind});
  }

  void take(const TableRow& row) override {
    auto column = columns_.begin();
    for_each_cell(row, table_.of_messages, [&](const Cell& cell) {
      column->take(cell);
      bytes_ += newest_bytes(*column++);
    });
    if (bytes_ >= kMostBytes) refuse();
  }

  void finish() override { file_.write(structure()); }

  /// Texts are counted as they come; numbers are known before.
  void check(std::uint64_t rows) const {
    if (rows * heads_.size() >= kMostBytes / sizeof(double)) refuse();
  }

 private:
  [[noreturn]] void refuse() const {
    throw std::runtime_error(file_.place() + ": " + table_.topic +
                             " is larger than the 2 GiB for each topic that a MATLAB file "
                             "allows: use --hdf5, which has no such limit, or --topics to leave "
                             "topics out");
  }

  Variable structure() {
    std::vector<const char*> names;
    for (const ColumnHead& head : heads_) names.push_back(head.name.c_str());
    Variable units = empty_structure(nullptr, names);
    Variable meta = empty_structure(nullptr, {"topic", "type", "units"});
    names.push_back("meta");
    Variable out = empty_structure(table_.name.c_str(), names);
    for (std::size_t c = 0; c < heads_.size(); ++c) {
      const char* name = heads_[c].name.c_str();
      set(units, name, text_variable(nullptr, heads_[c].unit));
      set(out, name, variable(name, columns_[c]));
    }
    set(meta, "topic", text_variable(nullptr, table_.topic));
    set(meta, "type", text_variable(nullptr, table_.type));
    set(meta, "units", std::move(units));
    set(out, "meta", std::move(meta));
    return out;
  }

  OpenMat& file_;
  TopicTable table_;
  std::vector<ColumnHead> heads_;
  std::vector<HeldColumn> columns_;  // one a head
  std::size_t bytes_ = 0;
};

class MatFile : public TableFile {
 public:
  explicit MatFile(const std::string& path) : pending_(path), file_(pending_.path(), path) {}

  std::unique_ptr<TableSink> add(const TopicTable& table, std::uint64_t rows) override {
    auto sink = std::make_unique<MatSink>(file_, table);
    sink->check(rows);
    return sink;
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
